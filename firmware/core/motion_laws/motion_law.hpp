// Stage 4, motion law: from the joints' reference to their torques. Several laws, chosen by servo.motion_law
// and changed while the arm moves; each is a file in this folder and a line in kMotionLaws (motion_laws.hpp).
//
// Gravity and motor friction are the arm's own affair at the seam. What friction it leaves to the servo, and
// springs, are the laws' affair, as far as the configuration says.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/trajectory/reference.hpp"

namespace fovea::motion_laws {

// What a law looks at.
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
  model::VecN cut;       // [num_joints] what the clamp took from the last torque; the integral waits for it
  // A change of laws: the torque's step, which fades away.
  config::MotionLawKind kind = config::MotionLawKind::kComputedTorque;
  model::VecN step;
  double since_change_s = 0.0;

  void Reset(config::MotionLawKind law, int num_joints) noexcept;
};

// Why the law `kind` may not drive an arm with the gains of a configuration.
enum class Unfit : std::uint8_t { kNone, kTooFewJoints, kDampedTooFast };

struct Fitness {
  Unfit why = Unfit::kNone;
  int joint = -1;        // kDampedTooFast: the joint, from 0
  double damping = 0.0;  // its damping over its inertia at the ready posture [1/s]
};

// Not for the tick: it makes the arm's dynamics.
[[nodiscard]] Fitness FitnessOf(const config::MotionLawConfig& config, const model::ArmModel& arm,
                                config::MotionLawKind kind) noexcept;

// Torques at the seam `tau` [num_joints] by the law that `state` names, and its step if there was a change.
// Real-time: yes.
void MotionLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs, MotionLawState& state,
               model::VecN& tau) noexcept;

// From now on the law `kind`; the torque goes from one to the other within config.change_s without a step,
// whatever each of them asks. `inputs` as in the last call. Real-time: yes.
void ChangeMotionLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                     config::MotionLawKind kind, MotionLawState& state) noexcept;

}  // namespace fovea::motion_laws
