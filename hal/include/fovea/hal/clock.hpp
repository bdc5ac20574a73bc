// SPDX-License-Identifier: Apache-2.0
// The loop's time: monotonic, in ns since an arbitrary start.
#pragma once

#include <cstdint>

#include "fovea/hal/status.hpp"

namespace fovea::hal {

// Real or virtual. All stamps in one loop are in the time of one Clock.
class Clock {
 public:
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

  // Never goes back. Real-time: yes.
  [[nodiscard]] std::int64_t NowNs() const noexcept { return DoNowNs(); }

  // Returns at `deadline_ns` or as soon after as the machine allows, at once when it has passed. A loop may
  // sleep here; a virtual clock advances its simulation to that time. The wait may be a system call, so
  // call this between ticks, never within one.
  // kClosed: the clock was stopped; time will not reach the deadline.
  [[nodiscard]] Status WaitUntil(std::int64_t deadline_ns) noexcept { return DoWaitUntil(deadline_ns); }

 protected:
  Clock() noexcept = default;
  ~Clock() = default;

 private:
  [[nodiscard]] virtual std::int64_t DoNowNs() const noexcept = 0;
  virtual Status DoWaitUntil(std::int64_t deadline_ns) noexcept = 0;
};

}  // namespace fovea::hal
