// Where a ball's edge is, along rays from a point inside it.
//
// Coarse: the strongest change of colour along the ray, to a pixel. Fine: to a fraction of a pixel, by area.
// Along a ray the profile falls from the ball's level to the background's; the area under it up to a point
// inside tells how far the edge is from there, whatever the lens' blur. The ball's level is not constant near
// the edge: with d the distance from it and r the outline's radius the surface turns away like
// z(d) = sqrt(2 d / r - d^2 / r^2), and the brightness follows, a + c z(d). How strongly, c, is fitted over
// all rays as c0 + c1 cos + s1 sin of the ray's angle: a light from any side.
#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace fovea::vision {

struct Edge {
  double u_px = 0.0;
  double v_px = 0.0;
  double du = 0.0;  // unit vector of its ray, outward
  double dv = 0.0;
};

struct EdgeSet {
  static constexpr int kMaxRays = 256;
  std::array<Edge, kMaxRays> list;
  int count = 0;          // edges found
  int rays = 0;           // rays looked along
  double contrast = 0.0;  // mean step across the edges [gray levels]
};

// Rays from (u_px, v_px), evenly round; `distance_px[i]` is where the edge of ray i is thought to be.
struct RayFan {
  double u_px = 0.0;
  double v_px = 0.0;
  int rays = 0;
  std::array<double, EdgeSet::kMaxRays> distance_px{};

  void Direction(int ray, double& du, double& dv) const;
};

// Looks for edges from `search_px` inside the expected place to as far outside it.
void FindCoarseEdges(const cv::Mat& image, const RayFan& fan, double search_px, EdgeSet& edges);

// Measures edges that are known to about two pixels. `radius_px` of the outline, for the shading; 0: assume
// none.
void MeasureFineEdges(const cv::Mat& image, const RayFan& fan, double radius_px, EdgeSet& edges);

}  // namespace fovea::vision
