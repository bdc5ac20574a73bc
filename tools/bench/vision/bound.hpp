// The Cramer-Rao bound: how well any detector without bias can know an outline's middle and radius from a
// picture.
//
// A pixel's mean brightness changes by the step across the outline times how much of the pixel the moving
// outline sweeps; those changes over the noise, squared and summed, are the Fisher information. The levels on
// both sides and the lens' blur count as known, so a real detector cannot quite get there. A polygon's
// unknowns are its corners' places, each for itself: its middle is their mean, as the detector's is.
#pragma once

#include "tools/bench/vision/picture.hpp"

namespace fovea::bench {

struct Bound {
  double centre_px = 0.0;  // standard deviation along one axis, rms of both
  double radius_px = 0.0;
};

// For the scene's first body. Parts of its outline that are hidden or outside the picture tell nothing.
Bound CramerRao(const PictureScene& scene);

}  // namespace fovea::bench
