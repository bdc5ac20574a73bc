// SPDX-License-Identifier: Apache-2.0
// Detection difficulty of a target and scatter of its feature, measured with the detectors on ray-cast
// pictures: the column "extraction difficulty" of the course exercises.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"

namespace fovea {

// Measured on the same set of pictures for all targets: `per_class` of each gray class of the benchmark.
struct Search {
  double found = 0.0;  // share of the pictures in which the target was found within 2 px
  double ms = 0.0;     // median time of a search without a hint
};
Search MeasureSearch(hal::FeatureKind target, int per_class);

// Scatter of s at one pose, over pictures that differ only in their noise.
struct Scatter {
  int found = 0;                  // of kPictures
  std::vector<double> per_level;  // standard deviation of each entry divided by the noise's [1 / gray level]
  double worst = 0.0;             // the largest, relative to the entry's range over the set's poses
  static constexpr int kPictures = 24;
  static constexpr double kNoise = 5.0;       // [gray levels]
  static constexpr double kContrast = 140.0;  // between target and ground [gray levels]
};
// Rows stacked below the feature do not come from pictures and are not measured.
Scatter MeasureScatter(const features::TargetFeature& feature, const model::Pose& X_CO);

}  // namespace fovea
