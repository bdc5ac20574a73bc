// SPDX-License-Identifier: Apache-2.0
// A loop's clock that shows the robot's own time: that of the newest state. For a robot whose time is not the
// computer's, such as a simulated one in lockstep.
#pragma once

#include <atomic>

#include "fovea/hal/clock.hpp"

namespace fovea::franka {

class RobotClock final : public hal::Clock {
 public:
  // From the arm's thread: a state with time `time_ns` arrived. Real-time: yes.
  void Advance(std::int64_t time_ns) noexcept;

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override {
    return now_ns_.load(std::memory_order_relaxed);
  }
  // No state arrives while the loop waits here, so the computer's clock measures the wait.
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  std::atomic<std::int64_t> now_ns_{0};
};

}  // namespace fovea::franka
