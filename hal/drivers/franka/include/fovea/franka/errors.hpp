// SPDX-License-Identifier: Apache-2.0
// The robot's errors, in the order of the 41 flags of a state.
#pragma once

#include "fovea/franka/states.hpp"

namespace fovea::franka {

enum class Error : std::uint8_t {
  kJointPositionLimits,
  kCartesianPositionLimits,
  kSelfCollisionAvoidance,
  kJointVelocity,
  kCartesianVelocity,
  kForceControlSafety,
  kJointReflex,
  kCartesianReflex,
  kMaxGoalPoseDeviation,
  kMaxPathPoseDeviation,
  kCartesianVelocityProfileSafety,
  kJointPositionStartPoseInvalid,
  kJointPositionLimitsOfMotion,
  kJointVelocityLimitsOfMotion,
  kJointVelocityDiscontinuity,
  kJointAccelerationDiscontinuity,
  kCartesianPositionStartPoseInvalid,
  kCartesianElbowLimit,
  kCartesianVelocityLimits,
  kCartesianVelocityDiscontinuity,
  kCartesianAccelerationDiscontinuity,
  kCartesianElbowSignInconsistent,
  kCartesianStartElbowInvalid,
  kForceControllerDesiredForceTolerance,
  kStartElbowSignInconsistent,
  kCommunicationConstraints,
  kPowerLimit,
  kCartesianJointPositionLimits,
  kCartesianJointVelocityLimits,
  kCartesianJointVelocityDiscontinuity,
  kCartesianJointAccelerationDiscontinuity,
  kCartesianPositionInvalidFrame,
  kControllerTorqueDiscontinuity,
  kJointP2pInsufficientTorque,
  kTauJRange,
  kInstabilityDetection,
  kJointMoveInWrongDirection,
  kCartesianSpline,
  kJointViaPlanLimit,
  kBaseAccelerationTimeout,
  kBaseAccelerationInvalid,
};

// The interface's own name of an error; static storage. "none" past the last.
[[nodiscard]] const char* Name(Error error) noexcept;

// The name of the first flag that is set, or "none".
[[nodiscard]] const char* FirstError(const ErrorFlags& flags) noexcept;

}  // namespace fovea::franka
