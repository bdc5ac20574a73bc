// SPDX-License-Identifier: Apache-2.0
// The visual laws. Each uses another interaction matrix to reduce the feature's error. servo.interaction
// chooses one. Each is a function here and a line in kVisualLaws.
//
// All share e, the gain and the target's own motion (visual_law.hpp). They differ in the matrix that relates
// the feature's change to the camera's motion.
#pragma once

#include <array>

#include "firmware/core/config/law_config.hpp"
#include "firmware/core/features/feature_state.hpp"

namespace fovea::control {

// Writes the matrix that the law inverts into `feature.L_s`, which holds the current one. `L_s_star`: the one
// at the goal, of the same size. Real-time: yes.
using VisualLawFunction = void (*)(const features::InteractionMatrix& L_s_star,
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

// In the order of config::Interaction.
inline constexpr std::array<VisualLawFunction, config::kInteractionNames.size()> kVisualLaws{
    CurrentInteraction, DesiredInteraction, MeanInteraction};

}  // namespace fovea::control
