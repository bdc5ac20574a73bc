// Second half of finding a triangle or a square: exactly where. Edges along lines across each side
// (profiles.hpp), a robust line through each side's, corners where the lines meet, and their covariance.
#pragma once

#include <opencv2/core.hpp>

#include "fovea/vision/flat_pose.hpp"
#include "fovea/vision/polygon_finder.hpp"
#include "fovea/vision/profiles.hpp"

namespace fovea::vision {

struct PolygonFit {
  bool converged = false;
  CornerFit corners;
  double rms_px = 0.0;    // of the edges about the sides
  double noise_px = 0.0;  // what of that the image's noise explains
  double contrast = 0.0;  // mean step across them [gray levels]
  double quiet = 0.0;     // the image's noise away from them [gray levels]
  double seen = 0.0;      // share of the sides that is inside the image and on an edge
};

// Keeps the memory that a fit works in. One thread uses it.
class PolygonFitter {
 public:
  // Fits the polygon near `start`, whose sides may be some 2 px off; its corners turn from u to v.
  PolygonFit Fit(const cv::Mat& image, const Intrinsics& in, std::span<const ImagePoint> start);

 private:
  // A side's line: where it is off its expected place, a + b t, t from -1 to 1 along it [px].
  struct Side {
    double length = 0.0;
    double nu = 0.0, nv = 0.0;  // outward
    int from = 0, to = 0;       // its lines
    double a = 0.0, b = 0.0;
    Eigen::Matrix2d cov = Eigen::Matrix2d::Zero();
  };
  bool ReadLines(const cv::Mat& image, const Intrinsics& in, const PolygonFit& fit);
  bool FitSide(Side& side, PolygonFit& fit, double& rms2, double& noise2, double& weights);
  void MoveCorners(PolygonFit& fit) const;

  Profiles profiles_;
  std::array<ProfileLine, Profiles::kMaxLines> lines_;
  std::array<double, Profiles::kMaxLines> place_{};  // t of each line
  std::array<double, Profiles::kMaxLines> at_px_{};
  std::array<double, Profiles::kMaxLines> weight_{};
  std::array<Side, Detection::kMaxCorners> sides_;
  int count_ = 0;
};

}  // namespace fovea::vision
