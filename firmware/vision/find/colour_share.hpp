// SPDX-License-Identifier: Apache-2.0
// The share of an outline's inside that has the target's colour.
#pragma once

#include <span>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/find/colour_model.hpp"
#include "firmware/vision/picture.hpp"

namespace fovea::vision {

// The share, 0 to 1, of `points` (image pixels well inside the outline) with the target's colour; 1 in a gray
// image.
double ColourShare(const Picture& image, const ColourModel& colour, std::span<const ImagePoint> points);

}  // namespace fovea::vision
