// SPDX-License-Identifier: Apache-2.0
// Stage 4, motion law: computes the joints' torques from their reference. servo.motion_law chooses one of
// several laws; it can change while the arm moves. Each is a function and a line in motion_laws.hpp.
//
// Behind the seam the arm itself compensates gravity and motor friction. The laws compensate springs, and the
// friction that the arm leaves to the servo, as configured.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/trajectory/reference.hpp"

namespace fovea::motion_laws {

// The inputs of a law.
struct MotionLawInputs {
  const model::ArmModel& arm;
  const model::ArmPoses& poses;        // at q
  const model::ArmDynamics& dynamics;  // at q, dq
  const trajectory::Reference& reference;
  const model::VecN& q;   // [num_joints] measured
  const model::VecN& dq;  // [num_joints] measured
};

struct MotionLawState {
  model::VecN integral;  // [num_joints] of the error over time [rad s]
  model::VecN cut;  // [num_joints] what the clamp cut from the last torque; the integral does not grow there
  // A change of laws: the torque's step, which fades out.
  config::MotionLawKind kind = config::MotionLawKind::kComputedTorque;
  model::VecN step;
  double since_change_s = 0.0;

  void Reset(config::MotionLawKind law, int num_joints) noexcept;
};

// Why a law may not drive an arm with the configured gains.
enum class Unfit : std::uint8_t { kNone, kTooFewJoints, kDampedTooFast };

struct Fitness {
  Unfit why = Unfit::kNone;
  int joint = -1;        // kDampedTooFast: the joint, from 0
  double damping = 0.0;  // its damping over its inertia at the ready posture [1/s]
};

// Not for the tick: it computes the arm's dynamics.
[[nodiscard]] Fitness FitnessOf(const config::MotionLawConfig& config, const model::ArmModel& arm,
                                config::MotionLawKind kind) noexcept;

// Computes the torques at the seam, `tau` [num_joints], by the law that `state` names, plus its step after a
// change. Real-time: yes.
void MotionLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs, MotionLawState& state,
               model::VecN& tau) noexcept;

// Changes to the law `kind`. The torque moves from one law's to the other's within config.change_s, without a
// step. `inputs` as in the last call. Real-time: yes.
void ChangeMotionLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                     config::MotionLawKind kind, MotionLawState& state) noexcept;

}  // namespace fovea::motion_laws
