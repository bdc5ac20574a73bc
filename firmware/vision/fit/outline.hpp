// SPDX-License-Identifier: Apache-2.0
// The outline of a sphere at a known position, for drawing.
#pragma once

#include <vector>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea::vision {

// `count` points of the outline of cone `m` (features/sphere.hpp), at equal angles about its centre.
std::vector<ImagePoint> SphereOutline(const Intrinsics& intrinsics, const model::Vec3& m, int count);

}  // namespace fovea::vision
