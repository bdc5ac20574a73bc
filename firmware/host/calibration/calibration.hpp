// SPDX-License-Identifier: Apache-2.0
// Camera calibration: focal length, lens, and the camera's pose on the hand. Used before a run, not in the
// tick or at the camera's rate.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "firmware/host/calibration/board.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea::calibration {

// --- Focal length from views of one round target at distances that differ by known steps.

struct RadiusView {
  double radius_px = 0.0;
  double sigma_px = 0.0;  // its standard deviation
  double moved = 0.0;     // extra distance, compared with the first view [m]
};

struct FocalLength {
  double f_px = 0.0;
  double sigma_px = 0.0;
  double Z = 0.0;  // distance in the first view [m]
  double rms_px = 0.0;
};

// Least squares of r = f R / Z (disc) or r = f R / sqrt(Z^2 - R^2) (sphere on the axis) over f and the first
// distance; two views of a disc give f = 2 dZ r1 r2 / (D (r1 - r2)). CalibrationError: fewer than two views,
// or radii that do not strictly fall with the distance, in each step and altogether by more than their noise.
FocalLength SolveFocalLength(const std::vector<RadiusView>& views, double diameter, bool sphere);

// --- vision::Intrinsics from views of a board.

struct IntrinsicsResult {
  vision::Intrinsics intrinsics;
  double sigma_f_px = 0.0;
  double sigma_c_px = 0.0;
  double rms_px = 0.0;
  int views = 0;
};

// CalibrationError: too few views, views that all look from the same side or do not determine a camera, a fit
// that is worse than two pixels.
IntrinsicsResult SolveIntrinsics(const std::vector<BoardView>& views, const Board& board, cv::Size size);

// --- The camera's pose on the hand.

struct HandView {
  model::Pose X_BE;
  BoardView board;
};

struct HandEyeResult {
  model::Pose X_EC;
  double rms_mm = 0.0;   // of the board's position in B about its mean, over the views
  double rms_deg = 0.0;  // of the board's orientation in B about its mean
  double rms_px = 0.0;   // of the corners about their projections by the intrinsics
  int views = 0;
};

// CalibrationError: too few views, a hand that turned about only one axis, or intrinsics that do not fit the
// views.
HandEyeResult SolveHandEye(const std::vector<HandView>& views, const Board& board,
                           const vision::Intrinsics& intrinsics);

}  // namespace fovea::calibration
