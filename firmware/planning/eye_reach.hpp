// SPDX-License-Identifier: Apache-2.0
// How far from the camera the detector looks for a target.
#pragma once

#include <cmath>

namespace fovea::planning {

// Distances of the target's origin from the camera [m]; the defaults allow all.
struct EyeReach {
  double nearest = 0.0;
  double farthest = HUGE_VAL;
};

}  // namespace fovea::planning
