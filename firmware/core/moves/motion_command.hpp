// SPDX-License-Identifier: Apache-2.0
// A motion that a program commands, instead of following the target that the camera sees.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/types.hpp"

namespace fovea::moves {

enum class MotionKind : std::uint8_t {
  kNone,           // no command in this tick; it ends a stream of setpoints
  kJointSetpoint,  // the joints' state now, one of a stream: q, dq, ddq
  kPoseSetpoint,   // the end effector's state now, one of a stream: p_BE, R_BE, V_BE_B
  kJointGoal,      // the joints come to rest there: q
  kPoseGoal,       // the end effector comes to rest there: p_BE, R_BE
  kHome,           // the joints come to rest in the arm's ready posture
};

// A goal may be commanded in one tick or in many; the motion continues until it is reached. Another goal
// takes effect in the tick that commands it.
struct MotionCommand {
  MotionKind kind = MotionKind::kNone;
  hal::JointArray q{};                                      // [num_joints]
  hal::JointArray dq{};                                     // [num_joints]
  hal::JointArray ddq{};                                    // [num_joints]
  std::array<double, 3> p_BE{};                             // [m]
  std::array<double, 4> quaternion_BE{1.0, 0.0, 0.0, 0.0};  // w, x, y, z; of any length but 0
  std::array<double, 6> V_BE_B{};  // twist of E in axes of B, linear first [m/s, rad/s]
};

// The loop reads its commands here, once per tick.
class MotionSource {
 public:
  MotionSource(const MotionSource&) = delete;
  MotionSource& operator=(const MotionSource&) = delete;
  // The command at `now_ns`, the stamp of the newest arm state. Real-time: yes.
  virtual MotionCommand At(std::int64_t now_ns) noexcept = 0;

 protected:
  MotionSource() noexcept = default;
  ~MotionSource() = default;
};

}  // namespace fovea::moves
