// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/obstacle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fovea::barriers {
namespace {

Clearance ClearanceOf(const config::Box& box, const model::Vec3& p) noexcept {
  model::Vec3 outside = model::Vec3::Zero();  // vector from the box's nearest point
  double nearest_face = HUGE_VAL;
  int axis = 0;
  double side = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double below = box.low[i] - p[i];
    const double above = p[i] - box.high[i];
    outside[i] = above > 0.0 ? above : below > 0.0 ? -below : 0.0;
    if (-above < nearest_face) {
      nearest_face = -above;
      axis = i;
      side = 1.0;
    }
    if (-below < nearest_face) {
      nearest_face = -below;
      axis = i;
      side = -1.0;
    }
  }
  const double distance = outside.norm();
  if (distance > 0.0) {
    return {distance, outside / distance};
  }
  Clearance clearance;
  clearance.distance = -nearest_face;
  clearance.away = side * model::Vec3::Unit(axis);
  return clearance;
}

// The hand's point nearest to what `clearance_of` measures. One loop for each kind of obstacle: the tick asks
// often.
template <class ClearanceAt>
HandClearance NearestOfHand(const config::HandShape& hand, const model::Pose& X_BE,
                            const ClearanceAt& clearance_of) noexcept {
  HandClearance nearest{clearance_of(X_BE.p), X_BE.p};
  for (int k = 0; k < hand.num_balls; ++k) {
    const config::HandShape::Ball& ball = hand.balls[static_cast<std::size_t>(k)];
    const model::Vec3 p_BP = X_BE * ball.p_EP;
    Clearance clearance = clearance_of(p_BP);
    clearance.distance -= ball.radius;
    if (clearance.distance < nearest.clearance.distance) {
      nearest = {clearance, p_BP};
    }
  }
  return nearest;
}

// Half the derivative, by t, of the squared distance from a + t d to the box.
double HalfSlope(const config::Box& box, const model::Vec3& a, const model::Vec3& d, double t) noexcept {
  double slope = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double p = a[i] + t * d[i];
    slope += d[i] * (p > box.high[i] ? p - box.high[i] : p < box.low[i] ? p - box.low[i] : 0.0);
  }
  return slope;
}

// The t in [from, to] at which a + t d is deepest in the box, or the middle if no place is deeper than
// another. The depth is the smallest of six linear functions of t, so it is largest at an end or where two of
// them are equal.
double DeepestPlace(const config::Box& box, const model::Vec3& a, const model::Vec3& d, double from,
                    double to) noexcept {
  std::array<double, 6> depth{};  // below the face, at t = 0
  std::array<double, 6> rise{};   // with t
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    depth[i] = a[axis] - box.low[axis];
    rise[i] = d[axis];
    depth[i + 3] = box.high[axis] - a[axis];
    rise[i + 3] = -d[axis];
  }
  double deepest = 0.5 * (from + to);
  double most = -HUGE_VAL;
  const auto consider = [&](double t) {
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < depth.size(); ++k) {
      least = std::min(least, depth[k] + rise[k] * t);
    }
    if (least > most) {
      most = least;
      deepest = t;
    }
  };
  consider(deepest);
  consider(from);
  consider(to);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    for (std::size_t k = i + 1; k < depth.size(); ++k) {
      const double t = (depth[k] - depth[i]) / (rise[i] - rise[k]);
      if (t > from && t < to) {  // false for faces that never are equally far
        consider(t);
      }
    }
  }
  return deepest;
}

// The t in [0, 1] from `from` to `to` at which a + t d is in the box; false if there is none.
bool Enters(const config::Box& box, const model::Vec3& a, const model::Vec3& d, double& from,
            double& to) noexcept {
  from = 0.0;
  to = 1.0;
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0.0) {
      to = a[i] >= box.low[i] && a[i] <= box.high[i] ? to : -1.0;
      continue;
    }
    const double at_low = (box.low[i] - a[i]) / d[i];
    const double at_high = (box.high[i] - a[i]) / d[i];
    from = std::max(from, std::min(at_low, at_high));
    to = std::min(to, std::max(at_low, at_high));
  }
  return from <= to;
}

// The t in [0, 1] at which a + t d is nearest to the box. Outside, the squared distance is convex and,
// between the t at which the line passes a face's plane, quadratic: its slope rises, and is linear between
// these.
double NearestPlace(const config::Box& box, const model::Vec3& a, const model::Vec3& d) noexcept {
  double from = 0.0;
  double to = 0.0;
  if (Enters(box, a, d, from, to)) {
    return DeepestPlace(box, a, d, from, to);
  }
  if (HalfSlope(box, a, d, 0.0) >= 0.0) {
    return 0.0;
  }
  if (HalfSlope(box, a, d, 1.0) <= 0.0) {
    return 1.0;
  }
  double below = 0.0;  // the last known t before the minimum
  double above = 1.0;  // the first one behind it
  for (int i = 0; i < 3; ++i) {
    for (const double face : {box.low[i], box.high[i]}) {
      const double t = (face - a[i]) / d[i];
      if (t > below && t < above) {  // false for a line along the face
        (HalfSlope(box, a, d, t) < 0.0 ? below : above) = t;
      }
    }
  }
  const double slope = HalfSlope(box, a, d, below);
  return below - slope * (above - below) / (HalfSlope(box, a, d, above) - slope);
}

}  // namespace

Clearance ClearanceOf(const config::Obstacles& obstacles, int i, const model::Vec3& p_B) noexcept {
  if (i < obstacles.num_planes) {
    const config::Plane& plane = obstacles.planes[static_cast<std::size_t>(i)];
    return {plane.normal.dot(p_B) - plane.distance, plane.normal};
  }
  return ClearanceOf(obstacles.boxes[static_cast<std::size_t>(i - obstacles.num_planes)], p_B);
}

HandClearance ClearanceOf(const config::Obstacles& obstacles, int i, const config::HandShape& hand,
                          const model::Pose& X_BE) noexcept {
  if (i < obstacles.num_planes) {
    const config::Plane& plane = obstacles.planes[static_cast<std::size_t>(i)];
    return NearestOfHand(hand, X_BE, [&](const model::Vec3& p) {
      return Clearance{plane.normal.dot(p) - plane.distance, plane.normal};
    });
  }
  const config::Box& box = obstacles.boxes[static_cast<std::size_t>(i - obstacles.num_planes)];
  return NearestOfHand(hand, X_BE, [&](const model::Vec3& p) { return ClearanceOf(box, p); });
}

SegmentClearance ClearanceOf(const config::Box& box, const model::Vec3& a_B,
                             const model::Vec3& b_B) noexcept {
  const double s = NearestPlace(box, a_B, b_B - a_B);
  const model::Vec3 p_B = a_B + s * (b_B - a_B);
  return {ClearanceOf(box, p_B), p_B, s};
}

}  // namespace fovea::barriers
