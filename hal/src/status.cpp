// SPDX-License-Identifier: Apache-2.0
#include "fovea/hal/status.hpp"

namespace fovea::hal {

const char* ToString(StatusCode code) noexcept {
  switch (code) {
    case StatusCode::kOk: return "ok";
    case StatusCode::kTimeout: return "nothing arrived in time";
    case StatusCode::kClosed: return "closed";
    case StatusCode::kDisconnected: return "disconnected";
    case StatusCode::kDeviceFault: return "the device reports a fault";
    case StatusCode::kInvalidArgument: return "invalid argument";
    case StatusCode::kNonFinite: return "a value is not finite";
    case StatusCode::kOutOfRange: return "a value is out of range";
  }
  return "unknown status";
}

}  // namespace fovea::hal
