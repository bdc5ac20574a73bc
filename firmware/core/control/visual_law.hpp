// SPDX-License-Identifier: Apache-2.0
// Stage 2, visual law: computes the task that reduces the feature's error.
//
//   ds_cmd = lambda(|e|) e - ds/dt of the target's own motion          e = s_star - s
//   J_s dq = ds_cmd                                               J_s = L_s J_C
//
// The first line is that of a law of first order; visual_laws.hpp has them all.
//
// (Chaumette and Hutchinson, Visual servo control I and II, 2006 and 2007.) The joint velocities follow in
// the next stage, where the limits are known (resolve_motion.hpp); the secondary task uses the directions
// that the feature leaves free.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/control/visual_laws.hpp"
#include "firmware/core/features/feature_state.hpp"

namespace fovea::control {

struct VisualLawOutput {
  features::FeatureVector e;
  features::FeatureVector ds_cmd;  // commanded ds/dt from the camera's motion
  MotionTask task;                 // before smooth start and limits
};

// The law's two lines, one after the other. `feature.L_s`: as ChooseInteraction left it. Real-time: yes.
void CommandFeature(const config::LawConfig& config, const features::FeatureState& feature,
                    const LawJoints& joints, VisualLawOutput& output) noexcept;
void CommandJoints(const config::LawConfig& config, const model::ArmModel& arm,
                   const features::FeatureState& feature, const LawJoints& joints,
                   VisualLawOutput& output) noexcept;

// Both. Real-time: yes.
void VisualLaw(const config::LawConfig& config, const model::ArmModel& arm,
               const features::FeatureState& feature, const LawJoints& joints,
               VisualLawOutput& output) noexcept;

// The gain [1/s] at an error of size `e`, in the feature's own units: lambda_near at 0, with the slope
// lambda_slope there, and lambda at large errors,
//
//   lambda(e) = lambda + (lambda_near - lambda) / (1 + lambda_slope e / |lambda_near - lambda|),
//
// fast near the goal and slow far from it, or the reverse. Constant if lambda_near is 0. (ViSP's
// vpAdaptiveGain uses an exponential.) Real-time: yes.
[[nodiscard]] double GainAt(const config::LawConfig& config, double e) noexcept;

// Writes the matrix that the law inverts into `feature.L_s`, by the law that config.law selects
// (visual_laws.hpp). `L_s_star`: the matrix at the goal, of the same size. Real-time: yes.
void ChooseInteraction(const config::LawConfig& config, const features::InteractionMatrix& L_s_star,
                       features::FeatureState& feature) noexcept;

// Share of the commanded feature motion `ds_cmd` that the joint velocity `dq` achieves, by projection on
// ds_cmd: 1 for all of it, 0 for none. 1 if ds_cmd is zero. Real-time: yes.
[[nodiscard]] double Progress(const features::FeatureState& feature, const features::FeatureVector& ds_cmd,
                              const model::Mat6N& J_C, const model::VecN& dq) noexcept;

}  // namespace fovea::control
