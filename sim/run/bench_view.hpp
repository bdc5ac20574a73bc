// SPDX-License-Identifier: Apache-2.0
// A view of the bench from beside it, and paths drawn into that view.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "sim/render/exposure.hpp"
#include "sim/render/pinhole.hpp"

namespace fovea::sim {

struct BenchView {
  Eigen::Isometry3d X_BV = Eigen::Isometry3d::Identity();  // V has axes as C: x right, y down, z forward
  Pinhole pinhole;
};

// The view's lens for a picture of the given size.
Pinhole MakeBenchPinhole(int width_px, int height_px);
// A view that shows the whole arm of `exposure`.
BenchView MakeBenchView(const Exposure& exposure, const Pinhole& pinhole);

// Draws `path`, points in B [m], as a line into `bgr`. The top left pixel of `bgr` is that of the view.
void DrawPath(cv::Mat& bgr, const BenchView& view, const std::vector<Eigen::Vector3d>& path,
              const cv::Scalar& colour, int thickness);

}  // namespace fovea::sim
