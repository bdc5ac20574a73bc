// SPDX-License-Identifier: Apache-2.0
// The checks common to all camera drivers: arguments on the way in, geometry on the way out.
#include "fovea/hal/camera.hpp"

namespace fovea::hal {
namespace {

bool HasPossibleGeometry(const Frame& frame) {
  if (frame.width_px <= 0 || frame.height_px <= 0) {
    return false;
  }
  const std::int64_t row_bytes = std::int64_t{frame.width_px} * BytesPerPixel(frame.format);
  if (frame.stride_bytes < row_bytes) {
    return false;
  }
  const std::int64_t needed = std::int64_t{frame.stride_bytes} * (frame.height_px - 1) + row_bytes;
  return static_cast<std::int64_t>(frame.pixels.size()) >= needed;
}

}  // namespace

Status Camera::Acquire(Frame& frame, std::int64_t timeout_ns) noexcept {
  if (timeout_ns < 0) {
    return Status(StatusCode::kInvalidArgument, "Camera::Acquire timeout_ns");
  }
  Frame taken;
  const Status status = DoAcquire(taken, timeout_ns);
  if (!status.ok()) {
    return status;
  }
  if (!HasPossibleGeometry(taken)) {
    return Status(StatusCode::kDeviceFault, "Frame geometry");
  }
  frame = taken;
  return Status::Ok();
}

}  // namespace fovea::hal
