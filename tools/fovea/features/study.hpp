// What a feature controls at a pose: rank and condition of L_s, and the camera's twists that it does not see.
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
  bool refused = false;  // not before the camera, or the feature has no value there; nothing else is set
  features::FeatureState state;
  std::vector<double> sigma;  // singular values of L_s, falling
  int rank = 0;
  double condition = 0.0;  // infinite below full rank (of the smaller of both sizes)
  std::vector<std::string> controls;
  std::vector<FreeTwist> free;
};

// `feature` at `X_CO`, with what is stacked below it.
FeatureStudy Study(const features::TargetFeature& feature, const model::Pose& X_CO);

// X_CO for a camera at `p_OC` [m] in O that looks at the target's middle, with as little roll as can be.
model::Pose LookFrom(const model::Vec3& p_OC);

// "infinite" below full rank.
std::string ConditionText(double condition);

// The words for entries, size and parameters: "x, y, D/Z".
std::string Parameters(const features::TargetFeature& feature);

}  // namespace fovea
