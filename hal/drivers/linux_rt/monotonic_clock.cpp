// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/monotonic_clock.hpp"

#include <cerrno>
#include <ctime>

#include "fovea/hal/types.hpp"

namespace fovea::linux_rt {

std::int64_t MonotonicNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * hal::kNsPerSecond + now.tv_nsec;
}

void SleepUntilNs(std::int64_t time_ns) noexcept {
  if (time_ns < 0) {
    return;  // long past
  }
  const timespec time{time_ns / hal::kNsPerSecond, time_ns % hal::kNsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

std::int64_t MonotonicClock::DoNowNs() const noexcept { return MonotonicNs(); }

hal::Status MonotonicClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  SleepUntilNs(deadline_ns);
  return hal::Status::Ok();
}

}  // namespace fovea::linux_rt
