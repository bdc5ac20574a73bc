// SPDX-License-Identifier: Apache-2.0
// Detects an unstable control loop: a joint that oscillates faster and farther than any normal motion.
#pragma once

#include <array>
#include <cstdint>

#include "sim/panda/types.hpp"

namespace fovea::sim {

class SwingWatch {
 public:
  // Takes the measured `dq` [rad/s] of the next millisecond. True if a joint's speed has reversed its trend
  // kTurns times within kWindow, each time by kSwing or more.
  [[nodiscard]] bool Step(const Joints& dq);
  // Call it when a motion begins.
  void Clear() { *this = {}; }

 private:
  static constexpr std::size_t kTurns = 8;
  static constexpr std::int64_t kWindow = 250;  // [ms]: four oscillations in it are 16 Hz
  static constexpr double kSwing = 0.3;         // [rad/s]: about 15 rad/s^2 at 16 Hz

  struct Joint {
    double extreme = 0.0;  // extreme speed since the last reversal
    bool rises = true;
    std::array<std::int64_t, kTurns> turns{};  // times of the reversals; the oldest is at `next`
    std::size_t next = 0;
  };
  std::array<Joint, franka::kJoints> joints_{};
  std::int64_t now_ = kWindow + 1;  // so that the initial zeros in `turns` are outside the window
};

}  // namespace fovea::sim
