// SPDX-License-Identifier: Apache-2.0
// First stage of finding a triangle or a square: approximate corners. Cuts chains of edge points into
// straight pieces, and joins pieces that can follow one another around a convex polygon.
#pragma once

#include <vector>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/find/edge_map.hpp"

namespace fovea::vision {

struct PolygonLimits {
  double side_min_px = 12.0;
  double radius_min_px = 8.0;  // of the circle with its area
  double radius_max_px = 400.0;
  double seen_min = 0.45;  // share of its outline that must have edges
};

struct PolygonCandidate {
  int count = 0;
  // Ordered from u to v, clockwise on a screen.
  std::array<ImagePoint, Detection::kMaxCorners> corner{};
  double seen = 0.0;
};

// Radius of the circle with the polygon's area, sqrt(area / pi); negative if the corners turn the other way.
double RadiusOf(std::span<const ImagePoint> corners);

class PolygonFinder {
 public:
  // Polygons with `corners` corners, the one with the largest `seen` first.
  const std::vector<PolygonCandidate>& Find(const EdgeMap& map, int corners, const PolygonLimits& limits);

 private:
  struct Segment {
    double u0 = 0.0, v0 = 0.0, u1 = 0.0, v1 = 0.0;  // ends, with the brighter side on the left
    double du = 0.0, dv = 0.0;                      // unit vector
    double length = 0.0;
  };
  void Cut(std::span<const EdgePoint> piece, int depth);
  [[nodiscard]] bool Follows(const Segment& a, const Segment& b, double sign, ImagePoint& corner) const;
  void Extend(int depth, double sign);
  void Offer(double sign);
  [[nodiscard]] double Seen(const PolygonCandidate& polygon) const;

  const EdgeMap* map_ = nullptr;
  PolygonLimits limits_;
  int corners_ = 0;
  std::vector<Segment> segments_;
  std::array<int, Detection::kMaxCorners> chosen_{};
  std::array<ImagePoint, Detection::kMaxCorners> corner_{};
  std::vector<PolygonCandidate> candidates_;
};

}  // namespace fovea::vision
