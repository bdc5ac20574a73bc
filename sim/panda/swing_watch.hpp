// Whether a joint swings to and fro faster and farther than any motion wants it to: a loop that is not
// stable.
#pragma once

#include <array>
#include <cstdint>

#include "sim/panda/types.hpp"

namespace fovea::sim {

class SwingWatch {
 public:
  // One millisecond later; `dq` [rad/s] is measured. True when a joint's speed has turned round kTurns times
  // within kWindow, each time by kSwing or more.
  [[nodiscard]] bool Step(const Joints& dq);
  // A motion begins.
  void Clear() { *this = {}; }

 private:
  static constexpr std::size_t kTurns = 8;
  static constexpr std::int64_t kWindow = 250;  // [ms]: four swings in it are 16 Hz
  static constexpr double kSwing = 0.3;         // [rad/s]: at 16 Hz some 15 rad/s^2

  struct Joint {
    double extreme = 0.0;  // of the speed since it last turned
    bool rises = true;
    std::array<std::int64_t, kTurns> turns{};  // when; the oldest is at `next`
    std::size_t next = 0;
  };
  std::array<Joint, franka::kJoints> joints_{};
  std::int64_t now_ = kWindow + 1;  // so that the zeros in `turns` are long ago
};

}  // namespace fovea::sim
