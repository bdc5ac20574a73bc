// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/square.hpp"

#include "firmware/core/model/math.hpp"

namespace fovea::features {
namespace {

using Row6 = Eigen::Matrix<double, 1, 6>;

// The feature at one pose: its entries and their derivatives.
struct SideInImage {
  Eigen::Matrix<double, 4, 1> s;
  Eigen::Matrix<double, 4, 1> ds_dt_target;
  Eigen::Matrix<double, 4, 6> L;
};

bool See(const SquareSideFeature& feature, const TargetInCamera& target, SideInImage& seen) noexcept {
  const Polygon square = MakeSquare(feature.side);
  const bool is_corner = feature.anchor == SquareSideFeature::Anchor::kFirstCorner;
  ImagePoint a;
  ImagePoint b;
  ImagePoint anchor;
  if (!target.IsFinite() || !ComputePoint(target, square.corners[0], a) ||
      !ComputePoint(target, square.corners[1], b) ||
      !ComputePoint(target, is_corner ? square.corners[0] : model::Vec3::Zero(), anchor)) {
    return false;
  }
  const Vec2 d = b.xy - a.xy;
  const double length = d.norm();
  if (!(length >= SquareSideFeature::kMinSide)) {
    return false;
  }
  const Vec2 along = d / length;
  const Vec2 across(-along.y() / length, along.x() / length);  // d alpha = across . d(d)
  const Vec2 drift = b.dxy_dt_target - a.dxy_dt_target;
  const Mat26 L_d = b.L - a.L;
  seen.s << anchor.xy, model::Atan2(d.y(), d.x()), length;
  seen.ds_dt_target << anchor.dxy_dt_target, across.dot(drift), along.dot(drift);
  seen.L.topRows<2>() = anchor.L;
  seen.L.row(2) = across.x() * L_d.row(0) + across.y() * L_d.row(1);
  seen.L.row(3) = along.x() * L_d.row(0) + along.y() * L_d.row(1);
  return true;
}

}  // namespace

Polygon MakeSquare(double side) noexcept {
  const double h = 0.5 * side;
  Polygon square;
  square.num_corners = 4;
  square.corners = {model::Vec3(-h, -h, 0.0), model::Vec3(h, -h, 0.0), model::Vec3(h, h, 0.0),
                    model::Vec3(-h, h, 0.0)};
  return square;
}

bool SquareSideFeature::Compute(const TargetInCamera& target, FeatureState& state) const noexcept {
  SideInImage now;
  SideInImage goal;
  if (!See(*this, target, now) || !See(*this, {X_CO_star, model::Vec3::Zero(), model::Vec3::Zero()}, goal)) {
    return false;
  }
  if (now.s[2] - goal.s[2] > model::kPi) {
    now.s[2] -= 2.0 * model::kPi;
  } else if (now.s[2] - goal.s[2] < -model::kPi) {
    now.s[2] += 2.0 * model::kPi;
  }
  state.Resize(kDim);
  state.s = now.s;
  state.s_star = goal.s;
  state.ds_dt_target = now.ds_dt_target;
  state.L_s = now.L;
  return true;
}

}  // namespace fovea::features
