// How fast a target's place becomes a feature and its interaction matrix.
#pragma once

#include <vector>

#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// s, s_star and L_s of each listed feature: ns per call over random places before the camera.
std::vector<Figure> FeatureSpeed();

}  // namespace fovea::bench
