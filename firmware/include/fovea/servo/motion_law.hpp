// Stage 4, motion law: the partition law alpha/beta, with matrices (Craig, Introduction to Robotics, ch. 10).
//
//   tau = alpha (ddq_ref + k_v' e' + k_p' e) + beta      alpha = M(q),  beta = C(q, dq) dq,  e = q_ref - q
//
// gives e'' + k_v' e' + k_p' e = 0. Gravity and motor friction are the arm's own affair at the seam.
#pragma once

#include "fovea/model/dynamics.hpp"
#include "fovea/servo/guard_motion.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

// `tau` [num_joints] at the seam, for the measured `q` and `dq`. Real-time: yes.
void MotionLaw(const MotionLawConfig& config, const model::ArmDynamics& dynamics, const Reference& reference,
               const model::VecN& q, const model::VecN& dq, model::VecN& tau) noexcept;

// The damped stop of mode Fault: tau = -damping M dq, which takes the speed away like exp(-damping t).
// Real-time: yes.
void DampedStop(double damping, const model::ArmDynamics& dynamics, const model::VecN& dq,
                model::VecN& tau) noexcept;

}  // namespace fovea::servo
