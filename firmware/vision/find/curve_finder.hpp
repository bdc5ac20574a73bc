// SPDX-License-Identifier: Apache-2.0
// First stage of finding a sphere or disc: approximate curves. Cuts chains of edge points (edge_map.hpp) into
// pieces that a curve fits, then refits each curve to the points of all chains that lie on it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "firmware/vision/find/curve.hpp"
#include "firmware/vision/find/edge_map.hpp"

namespace fovea::vision {

struct RoundLimits {
  double radius_min_px = 10.0;
  double radius_max_px = 200.0;
  double aspect_min = 0.3;  // least ratio of minor to major axis
  double seen_min = 0.4;    // share of the curve that must have edges
};

template <class Curve>
struct CurveCandidate {
  Curve curve;
  Ellipse ellipse;
  double seen = 0.0;  // share of the curve that has edges
};

template <class Curve>
class CurveFinder {
 public:
  // The candidate with the largest `seen` first.
  const std::vector<CurveCandidate<Curve>>& Find(const EdgeMap& map, const Intrinsics& in,
                                                 const RoundLimits& limits);

 private:
  struct Fitted {
    Curve curve;
    double rms_px = 0.0;
    bool ok = false;
  };
  void TryPiece(std::span<const EdgePoint> piece, int depth);
  void Remember(std::span<const EdgePoint> piece);
  void TryPairs();
  void Offer(const Curve& curve);
  bool Gather(CurveCandidate<Curve>& candidate);
  Fitted FitPoints(std::span<const EdgePoint> points) const;
  [[nodiscard]] bool IsAllowed(const Ellipse& ellipse) const;

  const EdgeMap* map_ = nullptr;
  const Intrinsics* in_ = nullptr;
  RoundLimits limits_;
  static constexpr std::size_t kMostArcs = 12;
  std::array<std::span<const EdgePoint>, kMostArcs> arcs_;  // pieces that gave no curve alone
  std::size_t arc_count_ = 0;
  std::vector<EdgePoint> pair_;
  std::vector<EdgePoint> supporters_;
  std::vector<CurveCandidate<Curve>> candidates_;
};

}  // namespace fovea::vision
