// SPDX-License-Identifier: Apache-2.0
// Second stage of finding a triangle or a square: accurate corners. Measures edges along lines across each
// side (profiles.hpp), fits a robust line to each side, and intersects the lines into corners with a
// covariance. Hidden parts of a side (side_evidence.hpp) are left out, with a margin.
#pragma once

#include "firmware/vision/detector_config.hpp"
#include "firmware/vision/find/polygon_finder.hpp"
#include "firmware/vision/fit/profiles.hpp"
#include "firmware/vision/fit/side_evidence.hpp"
#include "firmware/vision/fit/side_line.hpp"
#include "firmware/vision/picture.hpp"
#include "firmware/vision/pose/flat_pose.hpp"

namespace fovea::vision {

struct PolygonFit {
  bool converged = false;
  CornerFit corners;
  double rms_px = 0.0;           // of the edges' distances from the sides
  double noise_px = 0.0;         // part of rms_px that the image's noise explains
  double contrast = 0.0;         // mean step across the sides [gray levels]
  double quiet = 0.0;            // the image's noise away from the sides [gray levels]
  double seen = 0.0;             // share of the sides that is inside the image and on an edge
  double least_on = 0.0;         // least share of a side's edges that are on its line
  double least_seen = 0.0;       // least share of a side where the target's colour ends
  double against = 0.0;          // share of the sides without the target or an object that hides it
  bool whole = false;            // no part is hidden: the target ends at all sides, which are straight
  bool bends_explained = false;  // an object in front explains all edges off their side's line
  int corners_hidden = 0;        // known only from the extended sides
};

// Reuses the working memory of a fit. For one thread.
class PolygonFitter {
 public:
  // `in_any_light`: see SideEvidence.
  PolygonFitter(const EdgeNoise& edge_noise, bool in_any_light)
      : edge_noise_(edge_noise), evidence_(in_any_light) {}
  // Fits the polygon near `start`, whose sides may be about 2 px off; corners ordered from u to v.
  PolygonFit Fit(const Picture& image, const Intrinsics& in, std::span<const ImagePoint> start);

  // The colours beside the sides that were fitted last.
  [[nodiscard]] const SideEvidence& evidence() const { return evidence_; }

 private:
  // `line` is the side's offset from its expected place.
  struct Side {
    double length = 0.0;
    double nu = 0.0, nv = 0.0;  // outward
    int from = 0, to = 0;       // its lines
    SideLine line;
  };
  bool PlaceLines(const Picture& image, const Intrinsics& in, const PolygonFit& fit);
  bool ReadLines(const Picture& image, const Intrinsics& in, const PolygonFit& fit);
  bool Approach(const Picture& image, const Intrinsics& in, double& blur, PolygonFit& fit);
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
  std::array<bool, Profiles::kMaxLines> off_{};  // its edge is off the side's line
  std::array<Side, Detection::kMaxCorners> sides_;
  std::array<SideEdge, Profiles::kMaxLines> edges_;   // of the side being fitted,
  std::array<int, Profiles::kMaxLines> edge_line_{};  // and the line of each
  int count_ = 0;
};

}  // namespace fovea::vision
