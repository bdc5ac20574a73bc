#include "fovea/servo/keep_sight.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::servo {
namespace {

using model::Vec3;

constexpr int kHandJoints = 2;  // the last ones carry the camera: what lies between them is not in its way
constexpr double kRate = 1.5;   // what is left may be used up no faster than exp(-rate t) [1/s]

// Where two segments are nearest to each other, as shares of their lengths.
struct Nearest {
  double distance = HUGE_VAL;
  double s = 0.0;            // on the line of sight, from the camera
  double t = 0.0;            // on the link's line, from its joint
  int joint = -1;            // that carries the link; -1: the base
  Vec3 p_BP = Vec3::Zero();  // the target's point that is looked at [m]
};

// Ericson, Real-Time Collision Detection, 2005, 5.1.9.
Nearest NearestOf(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2) noexcept {
  constexpr double kPoint = 1e-12;  // [m^2]
  const Vec3 d1 = q1 - p1;
  const Vec3 d2 = q2 - p2;
  const Vec3 r = p1 - p2;
  const double a = d1.squaredNorm();
  const double e = d2.squaredNorm();
  const double f = d2.dot(r);
  Nearest nearest;
  if (a <= kPoint) {
    nearest.t = e > kPoint ? std::clamp(f / e, 0.0, 1.0) : 0.0;
  } else if (e <= kPoint) {
    nearest.s = std::clamp(-d1.dot(r) / a, 0.0, 1.0);
  } else {
    const double b = d1.dot(d2);
    const double c = d1.dot(r);
    const double denominator = a * e - b * b;
    nearest.s = denominator > kPoint ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
    nearest.t = (b * nearest.s + f) / e;
    if (nearest.t < 0.0 || nearest.t > 1.0) {
      nearest.t = std::clamp(nearest.t, 0.0, 1.0);
      nearest.s = std::clamp((b * nearest.t - c) / a, 0.0, 1.0);
    }
  }
  nearest.distance = (p1 + nearest.s * d1 - p2 - nearest.t * d2).norm();
  return nearest;
}

Vec3 OriginOf(const Sight& sight, int joint) noexcept {
  return joint < 0 ? Vec3(Vec3::Zero()) : sight.poses.X_BL[static_cast<std::size_t>(joint)].p;
}

// Of all links and all lines of sight.
Nearest NearestLink(const model::ArmModel& arm, const Sight& sight) noexcept {
  Nearest nearest;
  for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
    const Vec3 p_BP = sight.X_BO * sight.outline.p_OP[k];
    for (int i = -1; i + 1 < arm.num_joints - kHandJoints; ++i) {
      Nearest candidate = NearestOf(sight.X_BC.p, p_BP, OriginOf(sight, i), OriginOf(sight, i + 1));
      if (candidate.distance < nearest.distance) {
        candidate.joint = i;
        candidate.p_BP = p_BP;
        nearest = candidate;
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfSight(const model::ArmModel& arm, const Sight& sight) noexcept {
  return NearestLink(arm, sight).distance;
}

void LimitSight(double clearance, const model::ArmModel& arm, const Sight& sight, const model::Mat6N& J_C,
                MotionLimits& limits) noexcept {
  constexpr double kTouch = 1e-6;  // lines that cross have no direction apart [m]
  if (clearance <= 0.0) {
    return;
  }
  const Nearest nearest = NearestLink(arm, sight);
  if (!(nearest.distance > kTouch) || !std::isfinite(nearest.distance)) {
    return;
  }
  const Vec3 on_sight = sight.X_BC.p + nearest.s * (nearest.p_BP - sight.X_BC.p);
  const Vec3 on_link = OriginOf(sight, nearest.joint) +
                       nearest.t * (OriginOf(sight, nearest.joint + 1) - OriginOf(sight, nearest.joint));
  const Vec3 apart = (on_sight - on_link) / nearest.distance;
  // d/dt distance = apart . (v_sight - v_link); the line of sight turns about the target, which stays.
  const Vec3 apart_C = sight.X_BC.R.transpose() * apart;
  model::VecN gradient = (1.0 - nearest.s) * J_C.topRows<3>().transpose().lazyProduct(apart_C);
  model::LinearJacobian J_link;
  model::ComputeLinearJacobian(arm, sight.poses, on_link, J_link);
  for (int i = 0; i <= nearest.joint; ++i) {
    gradient[i] -= J_link.col(i).dot(apart);
  }
  limits.AddRow(-gradient, std::max(kRate * (nearest.distance - clearance), 0.0));
}

}  // namespace fovea::servo
