// SPDX-License-Identifier: Apache-2.0
// The detector's configuration for a picture's target, and the error of a detection.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/detector_config.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::bench {

vision::DetectorConfig ConfigOf(TargetKind kind, const PictureCamera& camera, vision::FindBy by);

std::vector<Eigen::Vector2d> CornersOf(const vision::Detection& detection);  // of a polygon [px]

// The error of the centre or of the worst corner, whichever is larger [px]. `corners` may begin with any
// corner. `corner_count`: the body's corners, 0 for a round body.
double OffOf(const Eigen::Vector2d& middle, std::span<const Eigen::Vector2d> corners,
             const TrueOutline& truth, std::size_t corner_count);
// The same for a detection of the scene's target.
double OffOf(const vision::Detection& detection, const PictureScene& scene);

}  // namespace fovea::bench
