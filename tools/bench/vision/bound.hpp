// SPDX-License-Identifier: Apache-2.0
// The Cramer-Rao bound: the smallest standard deviation of an outline's centre and radius that any unbiased
// detector can reach on a picture.
//
// When the outline moves, a pixel's mean brightness changes by the step across the outline times the swept
// part of the pixel. The Fisher information is the sum of the squares of these changes over the noise. The
// levels on both sides and the lens blur are assumed to be known, so a real detector stays above the bound.
// The unknowns of a polygon are the positions of its corners. Its centre is their mean, as in the detector.
#pragma once

#include "tools/bench/vision/picture.hpp"

namespace fovea::bench {

struct Bound {
  double centre_px = 0.0;  // standard deviation along one axis, rms of both
  double radius_px = 0.0;
};

// For the scene's first body. Parts of its outline that are hidden or outside the picture do not count.
Bound CramerRao(const PictureScene& scene);

}  // namespace fovea::bench
