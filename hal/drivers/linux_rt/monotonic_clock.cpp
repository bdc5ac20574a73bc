#include "fovea/linux_rt/monotonic_clock.hpp"

#include <cerrno>
#include <ctime>

#include "fovea/hal/types.hpp"

namespace fovea::linux_rt {

std::int64_t MonotonicClock::DoNowNs() const noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * hal::kNsPerSecond + now.tv_nsec;
}

hal::Status MonotonicClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  if (deadline_ns < 0) {
    return hal::Status::Ok();  // long past
  }
  const timespec deadline{deadline_ns / hal::kNsPerSecond, deadline_ns % hal::kNsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
  return hal::Status::Ok();
}

}  // namespace fovea::linux_rt
