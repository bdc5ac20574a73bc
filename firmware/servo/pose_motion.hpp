// Motions of the end effector: planned in its own six coordinates, followed by the joints.
#pragma once

#include "fovea/hal/events.hpp"
#include "fovea/servo/motion_command.hpp"
#include "fovea/servo/reference.hpp"
#include "fovea/servo/resolve_motion.hpp"
#include "fovea/servo/servo_config.hpp"
#include "fovea/servo/synchronised_move.hpp"

namespace fovea::servo {

// Where the end effector shall be, and how it shall move, in this tick.
struct PoseSetpoint {
  model::Pose X_BE;
  model::Vec6 V_BE_B = model::Vec6::Zero();  // [v; w] in axes of B
  bool is_end = false;                       // the joints shall come to rest too
};

// False when the command's numbers are no pose. Real-time: yes.
[[nodiscard]] bool ToSetpoint(const MotionCommand& command, PoseSetpoint& setpoint) noexcept;

// Plans from where `reference` has the end effector, with its velocity and acceleration, to rest at `X_BE`:
// six coordinates that end at zero, position less goal and the turn from the goal. Real-time: yes.
[[nodiscard]] bool PlanPose(const ServoConfig& config, const model::Pose& X_BE, const Reference& reference,
                            SynchronisedMove& move) noexcept;

// The setpoint `t` seconds into the move to `X_BE`. Real-time: yes.
[[nodiscard]] PoseSetpoint PoseAt(const model::Pose& X_BE, const SynchronisedMove& move, double t) noexcept;

// Moves the joints' reference on by a tick towards `setpoint`, through the guard. `refused` is set when the
// end effector is further from it than servo.pose_error_max: a limit forbids the way. `motion` is that
// of the tick before, its dq empty in the first, and becomes this one's. Real-time: yes.
hal::LimitSet FollowPose(const ServoConfig& config, const PoseSetpoint& setpoint, bool& refused,
                         ResolvedMotion& motion, Reference& reference) noexcept;

// Whether the reference stands at `X_BE`. Real-time: yes.
[[nodiscard]] bool StandsAt(const ServoConfig& config, const model::Pose& X_BE,
                            const Reference& reference) noexcept;

}  // namespace fovea::servo
