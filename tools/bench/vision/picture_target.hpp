// A picture's target as a detector is told of it, and how far off is what it says.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/detect/detector_config.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::bench {

vision::DetectorConfig ConfigOf(TargetKind kind, const PictureCamera& camera, vision::FindBy by);

std::vector<Eigen::Vector2d> CornersOf(const vision::Detection& detection);  // of a polygon [px]

// How far the middle is off, or the corner that is furthest off, whichever corner is named first [px].
// `corner_count`: the body's corners, 0 of what is round.
double OffOf(const Eigen::Vector2d& middle, std::span<const Eigen::Vector2d> corners,
             const TrueOutline& truth, std::size_t corner_count);
// The same of what a detector says of the scene's target.
double OffOf(const vision::Detection& detection, const PictureScene& scene);

}  // namespace fovea::bench
