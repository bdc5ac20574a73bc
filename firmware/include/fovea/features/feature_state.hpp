// A visual feature at one instant: what the visual law works on, whatever the target is.
#pragma once

#include "fovea/model/types.hpp"

namespace fovea::features {

inline constexpr int kMaxDim = hal::kMaxFeatureDim;

using FeatureVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxDim, 1>;
using InteractionMatrix = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, kMaxDim, 6>;

struct FeatureState {
  FeatureVector s;             // [dim]
  FeatureVector s_star;        // [dim] goal
  FeatureVector ds_dt_target;  // [dim] ds/dt owing to the target's own motion [1/s]
  InteractionMatrix L_s;       // [dim x 6] ds/dt = L_s V_BC_C for a target at rest
};

}  // namespace fovea::features
