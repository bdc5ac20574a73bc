// SPDX-License-Identifier: Apache-2.0
// Motions of the end effector: planned in its own six coordinates, followed by the joints.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/guard/known_clearances.hpp"
#include "firmware/core/moves/motion_command.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "firmware/core/trajectory/synchronised_move.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::moves {

// The end effector's commanded pose and twist in this tick.
struct PoseSetpoint {
  model::Pose X_BE;
  model::Vec6 V_BE_B = model::Vec6::Zero();  // [v; w] in axes of B
  bool is_end = false;                       // the joints come to rest too
};

// False if the command's numbers are not a pose. Real-time: yes.
[[nodiscard]] bool ToSetpoint(const MotionCommand& command, PoseSetpoint& setpoint) noexcept;

// Plans from the end effector's pose, velocity and acceleration at `reference` to rest at `X_BE`, in six
// coordinates that end at zero: position less goal, and the turn from the goal. Real-time: yes.
[[nodiscard]] bool PlanPose(const config::ServoConfig& config, const model::Pose& X_BE,
                            const trajectory::Reference& reference,
                            trajectory::SynchronisedMove& move) noexcept;

// The setpoint `t` seconds into the move to `X_BE`. Real-time: yes.
[[nodiscard]] PoseSetpoint PoseAt(const model::Pose& X_BE, const trajectory::SynchronisedMove& move,
                                  double t) noexcept;

// Advances the joints' reference by a tick towards `setpoint`, through the guard. Sets `refused` if the end
// effector is further from it than servo.pose_error_max: a limit blocks the path. `motion`: that of the
// previous tick, with empty dq in the first; becomes that of this tick. Real-time: yes.
hal::LimitSet FollowPose(const config::ServoConfig& config, const PoseSetpoint& setpoint, bool& refused,
                         control::ResolvedMotion& motion, guard::KnownClearances& known,
                         trajectory::Reference& reference) noexcept;

// True if the reference stands at `X_BE`. Real-time: yes.
[[nodiscard]] bool StandsAt(const config::ServoConfig& config, const model::Pose& X_BE,
                            const trajectory::Reference& reference) noexcept;

}  // namespace fovea::moves
