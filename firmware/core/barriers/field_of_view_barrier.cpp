// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/field_of_view_barrier.hpp"

#include <algorithm>

#include "firmware/core/features/point.hpp"

namespace fovea::barriers {
namespace {

// One side of the picture: sign * (x or y) must not exceed sign * bound.
struct Side {
  Eigen::Index axis;
  double sign;
  double bound;
};

}  // namespace

PictureBarriers FieldOfViewBarriers(const config::GuardConfig& guard, const ViewedTarget& target) noexcept {
  const config::ViewConfig& view = guard.view;
  PictureBarriers barriers;
  if (!view.enabled) {
    return barriers;
  }
  const auto n = static_cast<std::size_t>(target.outline.num_points);
  std::array<features::ImagePoint, features::Polygon::kMost> points;
  std::array<double, features::Polygon::kMost> reach{};  // outline radius at each point, in the image
  for (std::size_t i = 0; i < n; ++i) {
    if (!features::ComputePoint(target.seen, target.outline.p_OP[i], points[i])) {
      return barriers;
    }
    const model::Vec3 p_C = target.seen.X_CO * target.outline.p_OP[i];
    reach[i] = target.outline.radius / p_C.z();
  }
  const std::array<Side, 4> sides{{{0, -1.0, view.x_min},
                                   {0, 1.0, view.x_max},  //
                                   {1, -1.0, view.y_min},
                                   {1, 1.0, view.y_max}}};
  for (std::size_t k = 0; k < barriers.size(); ++k) {
    const Side& side = sides[k];
    const auto room = [&](std::size_t i) {
      return side.sign * (side.bound - points[i].xy[side.axis]) - reach[i];
    };
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < n; ++i) {
      nearest = room(i) < room(nearest) ? i : nearest;
    }
    const features::ImagePoint& point = points[nearest];
    const model::Vec6 along = side.sign * point.L.row(side.axis).transpose();
    barriers[k].name = hal::Limit::kFieldOfView;
    barriers[k].value = room(nearest);
    barriers[k].gradient = -target.J_C.transpose().lazyProduct(along);
    barriers[k].drift = -side.sign * point.dxy_dt_target[side.axis];
    barriers[k].rate = guard.barrier_rate;
  }
  return barriers;
}

PictureBarriers FieldOfViewBarriersOnPlan(const config::GuardConfig& guard,
                                          const ViewedTarget& target) noexcept {
  constexpr double kRate = 8.0;  // [1/s]
  PictureBarriers barriers = FieldOfViewBarriers(guard, target);
  for (Barrier& side : barriers) {
    side.rate = std::max(side.rate, kRate);
  }
  return barriers;
}

}  // namespace fovea::barriers
