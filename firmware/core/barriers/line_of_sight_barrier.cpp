// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/line_of_sight_barrier.hpp"

#include <cmath>

#include "firmware/core/model/segments.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

// The closest approach of a line of sight and a link.
struct LinkAtSight {
  model::SegmentPair axes;  // first: line of sight from the camera; second: the link's axis
  double gap = HUGE_VAL;    // from the line of sight to the link [m]
  int body = 0;             // the link
};

// Over all links and all lines of sight.
LinkAtSight NearestLink(const Sight& sight) noexcept {
  LinkAtSight nearest;
  for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
    const Vec3 p_BP = sight.X_BO * sight.outline.p_OP[k];
    for (int i = 0; i + model::ArmShape::kNeighbours + 1 < sight.bodies.size; ++i) {
      const PlacedCapsule& link = sight.bodies.body[static_cast<std::size_t>(i)];
      const model::SegmentPair axes = model::NearestOfSegments(sight.X_BC.p, p_BP, link.p_BA, link.p_BB);
      const double gap = axes.distance - link.radius;
      if (gap < nearest.gap) {
        nearest = {axes, gap, i};
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfSight(const Sight& sight) noexcept { return NearestLink(sight).gap; }

Barrier LineOfSightBarrier(const config::ServoConfig& config, const Sight& sight,
                           const model::Mat6N& J_C) noexcept {
  constexpr double kTouch = 1e-6;  // if lines cross, the direction between them is undefined [m]
  Barrier barrier;
  if (config.guard.sight_clearance <= 0.0) {
    return barrier;
  }
  const LinkAtSight nearest = NearestLink(sight);
  const model::SegmentPair& axes = nearest.axes;
  if (!std::isfinite(nearest.gap) || !(axes.distance > kTouch)) {
    return barrier;
  }
  const Vec3 apart = (axes.on_first - axes.on_second) / axes.distance;
  // d/dt distance = apart . (v_sight - v_link); the line of sight pivots about the fixed target.
  const Vec3 apart_C = sight.X_BC.R.transpose() * apart;
  barrier.gradient = (1.0 - axes.s) * J_C.topRows<3>().transpose().lazyProduct(apart_C);
  model::LinearJacobian J_link;
  model::ComputeLinearJacobian(config.arm, sight.poses, axes.on_second, J_link);
  for (int i = 0; i < nearest.body; ++i) {
    barrier.gradient[i] -= J_link.col(i).dot(apart);
  }
  barrier.name = hal::Limit::kFieldOfView;
  barrier.value = nearest.gap;
  barrier.margin = config.guard.sight_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
