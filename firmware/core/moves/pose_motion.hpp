// Motions of the end effector: planned in its own six coordinates, followed by the joints.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/moves/motion_command.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "firmware/core/trajectory/synchronised_move.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::moves {

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
[[nodiscard]] bool PlanPose(const config::ServoConfig& config, const model::Pose& X_BE,
                            const trajectory::Reference& reference,
                            trajectory::SynchronisedMove& move) noexcept;

// The setpoint `t` seconds into the move to `X_BE`. Real-time: yes.
[[nodiscard]] PoseSetpoint PoseAt(const model::Pose& X_BE, const trajectory::SynchronisedMove& move,
                                  double t) noexcept;

// Moves the joints' reference on by a tick towards `setpoint`, through the guard. `refused` is set when the
// end effector is further from it than servo.pose_error_max: a limit forbids the way. `motion` is that
// of the tick before, its dq empty in the first, and becomes this one's. Real-time: yes.
hal::LimitSet FollowPose(const config::ServoConfig& config, const PoseSetpoint& setpoint, bool& refused,
                         control::ResolvedMotion& motion, trajectory::Reference& reference) noexcept;

// Whether the reference stands at `X_BE`. Real-time: yes.
[[nodiscard]] bool StandsAt(const config::ServoConfig& config, const model::Pose& X_BE,
                            const trajectory::Reference& reference) noexcept;

}  // namespace fovea::moves
