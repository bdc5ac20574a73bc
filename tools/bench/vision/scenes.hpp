// SPDX-License-Identifier: Apache-2.0
// The benchmark's classes of pictures.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "tools/bench/vision/picture.hpp"

namespace fovea::bench {

using TargetKind = hal::FeatureKind;

struct SceneClass {
  std::string name;
  double noise = 0.0;
  double blur_px = 0.0;
  double contrast_min = 80.0;  // between target and ground [gray levels]
  double contrast_max = 140.0;
  double hidden = 0.0;   // share of the outline that an object in front hides
  bool clutter = false;  // in colour, among objects of another colour, shape or size
  bool off_axis = false;
  // Goal for sphere and circle: rms error at most the larger of this and 1.3 times the bound; 0: no goal.
  double goal_px = 0.0;
};
const std::vector<SceneClass>& SceneClasses();

// The target of each kind, as the detector is configured for it.
features::TargetFeature TargetOf(TargetKind kind);

// Composes one picture of a class. The radius of the target's outline is 12 to 150 px.
PictureScene MakeScene(const SceneClass& scene_class, TargetKind kind, bool with_target, unsigned seed);

}  // namespace fovea::bench
