// Second half of finding a ball: exactly where. The outline's edge is measured to a fraction of a pixel along
// rays across it, and the cone of tangent rays is fitted to it.
//
// Along each ray the profile runs from the ball's colour to the background's. With both levels taken from
// the ray itself, the area under the normalised profile gives the edge's place without a model of the lens.
// The cone x . m = |x| is linear in m (features/sphere.hpp), so the fit is three unknowns, weighted least
// squares with Tukey's weights against rays that met something else (occluder, glare, neighbour).
#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "fovea/model/types.hpp"
#include "fovea/vision/ball_finder.hpp"
#include "fovea/vision/intrinsics.hpp"

namespace fovea::vision {

struct OutlineFit {
  bool converged = false;
  model::Vec3 m = model::Vec3::Zero();      // the cone
  model::Mat3 cov_m = model::Mat3::Zero();  // its covariance
  double u_px = 0.0;                        // centre of the outline
  double v_px = 0.0;
  double radius_px = 0.0;  // of the circle with the outline's area
  double rms_px = 0.0;     // of the edge points about the outline
  double contrast = 0.0;   // mean step across the edge [gray levels]
  double seen = 0.0;       // share of the outline that is inside the image and on an edge
};

// Fits the outline near `start`. `search_px` is how far the edge may be from there. Not converged when too
// little of an outline is there. `image` is CV_8UC3 or CV_8UC1, of the intrinsics' size.
OutlineFit FitOutline(const cv::Mat& image, const Intrinsics& intrinsics, const Circle& start,
                      double search_px);

// The point of the cone's outline in direction (du, dv) from (u, v), a point inside; distance in pixels
// along that direction, found by Newton's method from `start_px`.
double OutlineDistance(const Intrinsics& intrinsics, const model::Vec3& m, double u_px, double v_px,
                       double du, double dv, double start_px);

// `count` points (u, v) of the cone's outline [px], evenly turned about the image of its axis; for drawing.
std::vector<std::pair<double, double>> OutlinePoints(const Intrinsics& intrinsics, const model::Vec3& m,
                                                     int count);

}  // namespace fovea::vision
