// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/film/target_curve.hpp"

#include <cmath>
#include <numbers>

#include "firmware/core/features/sphere.hpp"

namespace fovea::film {
namespace {

constexpr int kPoints = 96;
constexpr double kNearest = 1e-3;  // [m]

}  // namespace

Overlay::Curve TargetCurve(const vision::Intrinsics& in, const features::TargetFeature& target,
                           const model::Pose& X_CO) {
  if (features::TraitsOf(target.target).body == features::TargetBody::kBall) {
    return X_CO.p.z() > 1.1 * target.radius
               ? Overlay::CurveOf(in, features::ConeFromSphere(X_CO.p / target.radius))
               : Overlay::Curve();
  }
  Overlay::Curve curve;
  const int corners = target.corners.num_corners;
  for (int i = 0; i < kPoints; ++i) {
    model::Vec3 p_OP = model::Vec3::Zero();
    if (target.SeesOrientation()) {
      const int per_edge = kPoints / corners;
      const auto from = static_cast<std::size_t>(i / per_edge % corners);
      const auto to = (from + 1) % static_cast<std::size_t>(corners);
      const double share = static_cast<double>(i % per_edge) / per_edge;
      p_OP = (1.0 - share) * target.corners.corners[from] + share * target.corners.corners[to];
    } else {
      const double angle = 2.0 * std::numbers::pi * i / kPoints;
      p_OP = {target.radius * std::cos(angle), target.radius * std::sin(angle), 0.0};
    }
    const model::Vec3 p = X_CO * p_OP;
    if (!(p.z() > kNearest)) {
      return {};
    }
    curve.push_back({in.U(p), in.V(p)});
  }
  return curve;
}

}  // namespace fovea::film
