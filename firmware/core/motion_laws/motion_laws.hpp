// SPDX-License-Identifier: Apache-2.0
// The laws themselves, and their list. Each writes `tau` [num_joints] at the seam.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/motion_laws/motion_law.hpp"

namespace fovea::motion_laws {

// The partition law alpha/beta with matrices (Craig, Introduction to Robotics, ch. 10):
//
//   tau = alpha (ddq_ref + k_v' e' + k_p' e + k_i' integral of e) + beta                      e = q_ref - q
//   alpha = M(q),  beta = C(q, dq) dq + friction + springs
//
// gives e'' + k_v' e' + k_p' e + ... = 0 in every joint, alike: k_p' = omega_n^2, k_v' = 2 zeta omega_n,
// k_i' = integral k_p'. The integral stops growing in a joint whose torque the clamp cut, or whose share of
// the torque is at its bound.
void ComputedTorque(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                    MotionLawState& state, model::VecN& tau) noexcept;

// Each joint by itself: tau = k_p e + k_v e' + friction. With the arm's gravity compensation it is stable at
// any posture (Takegaki and Arimoto, 1981), knows nothing of M, and follows a fast reference badly.
void PdLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs, MotionLawState& state,
           model::VecN& tau) noexcept;

// A spring and a damper between each joint and its reference; the arm's dynamics along the reference are
// compensated: tau = M ddq_ref + C dq + k_p e + k_v e' + friction + springs. Without k_v the damper follows
// the inertia, 2 zeta sqrt(k_p M_ii). It yields when pushed (Hogan, Impedance control, 1985).
void JointImpedance(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                    MotionLawState& state, model::VecN& tau) noexcept;

// Controls the end effector's error with its own inertia, and the posture in the null space (Khatib, A
// unified approach for motion and force control: the operational space formulation, 1987):
//
//   tau = J^T Lambda (a_ref + k_v' (V_ref - V) + k_p' e_x - dJ/dt dq) + C dq
//         + N^T M (ddq_ref + k_v' e' + k_p' e) + friction + springs
//   Lambda = (J M^-1 J^T)^-1,  N^T = 1 - J^T Lambda J M^-1
//
// Lambda is damped, so that near a singularity it stays bounded. For arms of 6 joints and more.
void OperationalSpace(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                      MotionLawState& state, model::VecN& tau) noexcept;

// No torque: the arm floats on its gravity compensation, to be led by hand.
void Float(const config::MotionLawConfig& config, const MotionLawInputs& inputs, MotionLawState& state,
           model::VecN& tau) noexcept;

// The error dynamics of an undisturbed joint. A run with theory.enabled is compared with them.
enum class ErrorDynamics : std::uint8_t {
  kPlant,    // the joint's own inertia, friction and spring
  kSprings,  // the same, plus k_p and k_v
  kUnit,     // those are compensated: e'' + 2 zeta omega_n e' + omega_n^2 e = 0, and the integral's share
};

// The largest damping, k_v over a joint's inertia [1/s]. A 1 kHz loop with one period of delay is stable up
// to 1000 1/s (z = -1); these laws may use less than half. Springs ignore the coupling of the joints'
// inertias: at some postures a direction is ten times as light as a joint by itself.
inline constexpr double kDampingMost = 400.0;
inline constexpr double kSpringDampingMost = 75.0;

struct MotionLawEntry {
  config::MotionLawKind kind;
  void (*torque)(const config::MotionLawConfig&, const MotionLawInputs&, MotionLawState&,
                 model::VecN&) noexcept;
  int joints_min;  // arms with fewer joints cannot be driven by it
  bool carries;    // an unknown load is compensated while the arm stands; false: the law yields as a spring
  ErrorDynamics error = ErrorDynamics::kUnit;
  double damping_most = kDampingMost;
  bool has_springs = false;  // gains k_p and k_v per joint; false: omega_n and zeta for all joints
};

// In the order of MotionLawKind.
inline constexpr std::array<MotionLawEntry, config::kNumMotionLaws> kMotionLaws{{
    {config::MotionLawKind::kComputedTorque, ComputedTorque, 1, true},
    {config::MotionLawKind::kPd, PdLaw, 1, false, ErrorDynamics::kSprings, kSpringDampingMost, true},
    {config::MotionLawKind::kJointImpedance, JointImpedance, 1, false, ErrorDynamics::kUnit,
     kSpringDampingMost, true},
    {config::MotionLawKind::kOperationalSpace, OperationalSpace, 6, true},
    {config::MotionLawKind::kFloat, Float, 1, false, ErrorDynamics::kPlant},
}};

[[nodiscard]] inline const MotionLawEntry& EntryOf(config::MotionLawKind kind) noexcept {
  return kMotionLaws[static_cast<std::size_t>(kind)];
}

}  // namespace fovea::motion_laws
