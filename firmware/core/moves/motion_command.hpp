// A motion that a program asks for, instead of the target that the camera sees.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/types.hpp"

namespace fovea::moves {

enum class MotionKind : std::uint8_t {
  kNone,           // nothing is commanded in this tick; a stream that gives none has ended
  kJointSetpoint,  // where the joints shall be now, one of a stream: q, dq, ddq
  kPoseSetpoint,   // where the end effector shall be now, one of a stream: p_BE, R_BE, V_BE_B
  kJointGoal,      // where the joints shall come to rest: q
  kPoseGoal,       // where the end effector shall come to rest: p_BE, R_BE
  kHome,           // the joints shall come to rest in the arm's ready posture
};

// A goal is asked for in one tick or in many; the motion to it goes on until it is there. Another goal takes
// effect in the tick that asks for it.
struct MotionCommand {
  MotionKind kind = MotionKind::kNone;
  hal::JointArray q{};                                      // [num_joints]
  hal::JointArray dq{};                                     // [num_joints]
  hal::JointArray ddq{};                                    // [num_joints]
  std::array<double, 3> p_BE{};                             // [m]
  std::array<double, 4> quaternion_BE{1.0, 0.0, 0.0, 0.0};  // w, x, y, z; of any length but 0
  std::array<double, 6> V_BE_B{};  // twist of E in axes of B, linear first [m/s, rad/s]
};

// Where the loop takes its commands from, once per tick.
class MotionSource {
 public:
  MotionSource(const MotionSource&) = delete;
  MotionSource& operator=(const MotionSource&) = delete;
  // What is asked for at `now_ns`, the stamp of the newest arm state. Real-time: yes.
  virtual MotionCommand At(std::int64_t now_ns) noexcept = 0;

 protected:
  MotionSource() noexcept = default;
  ~MotionSource() = default;
};

}  // namespace fovea::moves
