// SPDX-License-Identifier: Apache-2.0
// What a feature controls at a pose: rank and condition of L_s, and the camera twists that do not change it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"

namespace fovea {

struct FreeTwist {
  Eigen::Matrix<double, 6, 1> V_BC_C;  // of length 1; linear first [m, rad]
  std::string words;
};

struct FeatureStudy {
  bool refused = false;  // not in front of the camera, or no value there; nothing else is set
  features::FeatureState state;
  std::vector<double> sigma;  // singular values of L_s, in descending order
  int rank = 0;
  double condition = 0.0;  // infinite below full rank, min(rows, 6)
  std::vector<std::string> controls;
  std::vector<FreeTwist> free;
};

// Analyses `feature` at `X_CO`, with the rows stacked below it.
FeatureStudy Study(const features::TargetFeature& feature, const model::Pose& X_CO);

// X_CO for a camera at `p_OC` [m] in O that looks at the target's centre, with the least possible roll.
model::Pose LookFrom(const model::Vec3& p_OC);

// "infinite" below full rank.
std::string ConditionText(double condition);

// The entries of s as text, such as "x, y, D/Z".
std::string Parameters(const features::TargetFeature& feature);

}  // namespace fovea
