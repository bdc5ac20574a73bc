// How hard it is to get a feature out of a picture, measured with the detectors on ray-cast pictures: the
// source's column "extraction difficulty".
#pragma once

#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"

namespace fovea {

// On one set of pictures for all targets: `per_class` of each of the benchmark's classes in gray.
struct Search {
  double found = 0.0;  // share of the pictures in which the target was found, no more than 2 px off
  double ms = 0.0;     // median time of a search without a hint
};
Search MeasureSearch(hal::FeatureKind target, int per_class);

// Of s at one pose, over pictures that differ by their noise alone.
struct Scatter {
  int found = 0;                  // of kPictures
  std::vector<double> per_level;  // standard deviation of each entry, over that of the noise [1 / gray level]
  double worst = 0.0;             // the largest of them, relative to its entry's range over the set's poses
  static constexpr int kPictures = 24;
  static constexpr double kNoise = 5.0;       // [gray levels]
  static constexpr double kContrast = 140.0;  // of the target on its ground [gray levels]
};
// What is stacked below the feature is not seen in pictures and not counted.
Scatter MeasureScatter(const features::TargetFeature& feature, const model::Pose& X_CO);

}  // namespace fovea
