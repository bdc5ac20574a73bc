// SPDX-License-Identifier: Apache-2.0
// The visual laws. Each is a line of kVisualLaws, and one of config::kLaws with its name. servo.law chooses
// one.
//
// All share e, the gain and the target's own motion (visual_law.hpp), and all limits apply to each of them.
// They differ in three ways: in the feature (config::LawTraits::form), in the matrix that relates its change
// to the camera's motion, and in how its motion follows from its error.
//
//   law            feature            known for
//
//   ibvs           picture            bears wrong calibration; retreats from turns about the optical axis
//
//   mean           picture            right to second order; straighter from far away
//
//   desired        picture            as mean, and never singular unless the goal is; detours
//
//   pbvs           pose               a straight way of the target's centre in C; corners may leave the
//   picture
//
//   hybrid         x, y, ln Z, turn   no local minimum; the centre's way in the picture is straight
//
//   second_order   picture            accelerates smoothly from any motion; no overshoot
//
//   predictive     picture            sees limits ahead; as mean, where no horizon is there (horizon.hpp)
#pragma once

#include <array>

#include "firmware/core/config/law_config.hpp"
#include "firmware/core/features/feature_state.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::control {

// Writes the matrix that the law inverts into `feature.L_s`, which holds the current one. `L_s_star`: the one
// at the goal, of the same size. Real-time: yes.
using InteractionChoice = void (*)(const features::InteractionMatrix& L_s_star,
                                   features::FeatureState& feature) noexcept;

// The current matrix: the classical law (Chaumette and Hutchinson, Visual servo control I, 2006).
inline void CurrentInteraction(const features::InteractionMatrix& /*L_s_star*/,
                               features::FeatureState& /*feature*/) noexcept {}

// The matrix at the goal: straighter image paths from far away, and never singular unless the goal is.
inline void DesiredInteraction(const features::InteractionMatrix& L_s_star,
                               features::FeatureState& feature) noexcept {
  feature.L_s = L_s_star;
}

// The mean of both: right to second order (Malis, Improving vision-based control using efficient second-order
// minimization techniques, 2004).
inline void MeanInteraction(const features::InteractionMatrix& L_s_star,
                            features::FeatureState& feature) noexcept {
  feature.L_s = 0.5 * (feature.L_s + L_s_star);
}

// The joints at a tick, each [num_joints].
struct LawJoints {
  const model::Mat6N& J_C;          // [6 x num_joints] body Jacobian of the camera
  const model::VecN& q;             // measured
  const model::VecN& dq_reference;  // of the reference, in the previous tick
};

// What a feature's wanted motion follows from.
struct LawScene {
  const features::FeatureState& feature;
  const LawJoints& joints;
  const features::FeatureVector& e;  // error, s_star - s
  double gain = 0.0;                 // at this error [1/s]
};

// The wanted ds/dt, of the camera's and the target's motion together. Real-time: yes.
using MotionChoice = features::FeatureVector (*)(const LawScene& scene) noexcept;

// e' = -gain e
inline features::FeatureVector FirstOrder(const LawScene& scene) noexcept { return scene.gain * scene.e; }

// e'' = -2 omega e' - omega^2 e, integrated over a tick from the present motion. Critically damped: no
// overshoot. With omega = 1.5 gain, 2 % of the error are left after the same time as in first order (5.83 /
// omega against 3.91 / gain). (Fakhry and Wilson, A modified resolved acceleration controller for position
// based visual servoing, 1996; here on the picture, and dL_s/dt is part of the change of ds_dt from tick to
// tick.)
inline features::FeatureVector SecondOrder(const LawScene& scene) noexcept {
  const double omega = 1.5 * scene.gain;
  const model::Vec6 V_BC_C = scene.joints.J_C.lazyProduct(scene.joints.dq_reference);
  const features::FeatureVector ds_dt = scene.feature.L_s.lazyProduct(V_BC_C) + scene.feature.ds_dt_target;
  return ds_dt + hal::kTickPeriodS * (omega * omega * scene.e - 2.0 * omega * ds_dt);
}

struct VisualLawLine {
  InteractionChoice interaction;
  MotionChoice motion;
  // It starts smoothly by itself: servo.smooth_start_s does not apply.
  bool commands_acceleration = false;
  // It follows horizons of the planner; its matrix and motion are for the time without one.
  bool predicts = false;
};

// In the order of config::Law.
inline constexpr std::array<VisualLawLine, config::kLaws.size()> kVisualLaws{
    {{CurrentInteraction, FirstOrder},              // ibvs
     {CurrentInteraction, FirstOrder},              // pbvs
     {CurrentInteraction, FirstOrder},              // hybrid
     {MeanInteraction, FirstOrder},                 // mean
     {DesiredInteraction, FirstOrder},              // desired
     {CurrentInteraction, SecondOrder, true},       // second_order
     {MeanInteraction, FirstOrder, false, true}}};  // predictive

[[nodiscard]] constexpr const VisualLawLine& LineOf(config::Law law) noexcept {
  return kVisualLaws[static_cast<std::size_t>(law)];
}

}  // namespace fovea::control
