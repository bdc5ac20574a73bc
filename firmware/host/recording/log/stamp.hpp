// SPDX-License-Identifier: Apache-2.0
// Converts times to protobuf's stamps.
#pragma once

#include <google/protobuf/timestamp.pb.h>

#include <cstdint>

namespace fovea::log {

inline void SetStamp(std::int64_t time_ns, google::protobuf::Timestamp& stamp) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  stamp.set_seconds(time_ns / kSecond);
  stamp.set_nanos(static_cast<std::int32_t>(time_ns % kSecond));
}

}  // namespace fovea::log
