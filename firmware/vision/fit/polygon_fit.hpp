// Second half of finding a triangle or a square: exactly where. Edges along lines across each side
// (profiles.hpp), a robust line through each side's, corners where the lines meet, and their covariance. What
// stands before a side (side_evidence.hpp) is left out, and so is what is next to it.
#pragma once

#include <opencv2/core.hpp>

#include "firmware/vision/detect/detector_config.hpp"
#include "firmware/vision/detect/side_evidence.hpp"
#include "firmware/vision/find/polygon_finder.hpp"
#include "firmware/vision/fit/profiles.hpp"
#include "firmware/vision/fit/side_line.hpp"
#include "firmware/vision/pose/flat_pose.hpp"

namespace fovea::vision {

struct PolygonFit {
  bool converged = false;
  CornerFit corners;
  double rms_px = 0.0;      // of the edges about the sides
  double noise_px = 0.0;    // what of that the image's noise explains
  double contrast = 0.0;    // mean step across them [gray levels]
  double quiet = 0.0;       // the image's noise away from them [gray levels]
  double seen = 0.0;        // share of the sides that is inside the image and on an edge
  double least_on = 0.0;    // of the side that is least straight: share of its edges that are on its line
  double least_seen = 0.0;  // of the side of which least is seen, where the target's colour ends
  double against = 0.0;     // share of the sides where the target is not, and nothing hides it
  bool whole = false;       // nothing stands before it: the target ends at all sides, which are straight
  bool bends_explained = false;  // where edges leave a side's line, something stands before it
  int corners_hidden = 0;        // where they would be is only known from the sides
};

// Keeps the memory that a fit works in. One thread uses it.
class PolygonFitter {
 public:
  // `in_any_light`: see SideEvidence.
  PolygonFitter(const EdgeNoise& edge_noise, bool in_any_light)
      : edge_noise_(edge_noise), evidence_(in_any_light) {}
  // Fits the polygon near `start`, whose sides may be some 2 px off; its corners turn from u to v.
  PolygonFit Fit(const cv::Mat& image, const Intrinsics& in, std::span<const ImagePoint> start);

  // What stands beside the sides that were fitted last.
  [[nodiscard]] const SideEvidence& evidence() const { return evidence_; }

 private:
  // Its line is where it is off its expected place.
  struct Side {
    double length = 0.0;
    double nu = 0.0, nv = 0.0;  // outward
    int from = 0, to = 0;       // its lines
    SideLine line;
  };
  bool PlaceLines(const cv::Mat& image, const Intrinsics& in, const PolygonFit& fit);
  bool ReadLines(const cv::Mat& image, const Intrinsics& in, const PolygonFit& fit);
  bool Approach(const cv::Mat& image, const Intrinsics& in, double& blur, PolygonFit& fit);
  bool FitSide(Side& side, double blur, PolygonFit& fit, double& rms2, double& noise2, double& weights);
  void MoveCorners(PolygonFit& fit) const;
  [[nodiscard]] bool IsWhole(const PolygonFit& fit) const;

  const EdgeNoise edge_noise_;
  Profiles profiles_;
  SideEvidence evidence_;
  std::array<ProfileLine, Profiles::kMaxLines> lines_;
  std::array<double, Profiles::kMaxLines> place_{};  // t of each line
  std::array<double, Profiles::kMaxLines> at_px_{};
  std::array<double, Profiles::kMaxLines> weight_{};
  std::array<bool, Profiles::kMaxLines> off_{};  // its edge is, the side's line
  std::array<Side, Detection::kMaxCorners> sides_;
  std::array<SideEdge, Profiles::kMaxLines> edges_;   // of the side being fitted,
  std::array<int, Profiles::kMaxLines> edge_line_{};  // and on which line each is
  int count_ = 0;
};

}  // namespace fovea::vision
