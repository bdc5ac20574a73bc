// SPDX-License-Identifier: Apache-2.0
// Speed of computing a feature and its interaction matrix from a target's pose.
#pragma once

#include <vector>

#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// s, s_star and L_s of each listed feature: ns per call over random poses in front of the camera.
std::vector<Figure> FeatureSpeed();

}  // namespace fovea::bench
