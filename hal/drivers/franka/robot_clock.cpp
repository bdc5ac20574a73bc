// SPDX-License-Identifier: Apache-2.0
#include "fovea/franka/robot_clock.hpp"

#include <cerrno>
#include <ctime>

#include "fovea/hal/types.hpp"

namespace fovea::franka {

void RobotClock::Advance(std::int64_t time_ns) noexcept {
  if (time_ns > now_ns_.load(std::memory_order_relaxed)) {
    now_ns_.store(time_ns, std::memory_order_relaxed);
  }
}

hal::Status RobotClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  const std::int64_t left_ns = deadline_ns - DoNowNs();
  if (left_ns > 0) {
    timespec left{left_ns / hal::kNsPerSecond, left_ns % hal::kNsPerSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, 0, &left, &left) == EINTR) {
    }
    Advance(deadline_ns);
  }
  return hal::Status::Ok();
}

}  // namespace fovea::franka
