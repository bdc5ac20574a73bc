// The outline of a sphere whose place is known, for drawing.
#pragma once

#include <vector>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/pose/intrinsics.hpp"

namespace fovea::vision {

// `count` points of the outline of cone `m` (features/sphere.hpp), evenly turned about its middle.
std::vector<ImagePoint> SphereOutline(const Intrinsics& intrinsics, const model::Vec3& m, int count);

}  // namespace fovea::vision
