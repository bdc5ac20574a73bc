// Outlines of targets whose pose is known, for drawing.
#pragma once

#include <vector>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/detect/detector_config.hpp"

namespace fovea::vision {

// `count` points of the outline of cone `m` (features/sphere.hpp), evenly turned about its middle.
std::vector<ImagePoint> SphereOutline(const Intrinsics& intrinsics, const model::Vec3& m, int count);

// The outline of the target that `config` names at `X_CO`; of a square or triangle, its corners. Empty when a
// part of it is not before the camera.
std::vector<ImagePoint> TargetOutline(const DetectorConfig& config, const model::Pose& X_CO);

}  // namespace fovea::vision
