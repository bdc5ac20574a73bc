// Motions of the end effector: planned in its own six coordinates, followed by the joints.
#pragma once

#include "fovea/hal/events.hpp"
#include "fovea/servo/motion_command.hpp"
#include "fovea/servo/reference.hpp"
#include "fovea/servo/servo_config.hpp"
#include "fovea/servo/synchronised_move.hpp"

namespace fovea::servo {

// Plans from where `reference` has the end effector, with its velocity and acceleration, to rest at the goal's
// pose: six coordinates that end at zero, position less goal and the turn from the goal. False when the goal
// is no pose. Real-time: yes.
[[nodiscard]] bool PlanPose(const ServoConfig& config, const MotionCommand& goal, const Reference& reference,
                            SynchronisedMove& move) noexcept;

// Where the end effector shall be `t` seconds into the move, as a setpoint. Real-time: yes.
[[nodiscard]] MotionCommand PoseAt(const MotionCommand& goal, const SynchronisedMove& move, double t) noexcept;

// Moves the joints' reference on by a tick towards a pose setpoint, through the guard. `refused` is set when
// the setpoint is none, or the end effector has fallen behind it by more than servo.pose_error_max: a limit
// forbids the way. Real-time: yes.
hal::LimitSet FollowPose(const ServoConfig& config, const MotionCommand& setpoint, bool& refused,
                         Reference& reference) noexcept;

// Whether the reference stands at the goal. Real-time: yes.
[[nodiscard]] bool PoseReached(const ServoConfig& config, const MotionCommand& goal,
                               const Reference& reference) noexcept;

}  // namespace fovea::servo
