// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/line_of_sight_barrier.hpp"

#include <cmath>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/model/segments.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

// The closest approach of a line of sight to a link or a box.
struct NearSight {
  double gap = HUGE_VAL;      // between them [m]
  double s = 0.0;             // place on the line of sight, as a share from the camera
  Vec3 apart = Vec3::Zero();  // from the link or box to that place, in B [m]
  Vec3 p_BL = Vec3::Zero();   // on the link's axis [m]
  int body = 0;               // the link; 0: the base or a box, which do not move
};

// Over all links, boxes and lines of sight.
NearSight NearestOf(const Sight& sight) noexcept {
  constexpr double kShare = 0.9;  // of a line, from the camera, that boxes must keep clear
  NearSight nearest;
  for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
    const Vec3 p_BP = sight.X_BO * sight.outline.p_OP[k];
    for (int i = 0; i + model::ArmShape::kNeighbours + 1 < sight.bodies.size; ++i) {
      const PlacedCapsule& link = sight.bodies.body[static_cast<std::size_t>(i)];
      const model::SegmentPair axes = model::NearestOfSegments(sight.X_BC.p, p_BP, link.p_BA, link.p_BB);
      const double gap = axes.distance - link.radius;
      if (gap < nearest.gap) {
        nearest = {gap, axes.s, axes.on_first - axes.on_second, axes.on_second, i};
      }
    }
    for (int i = 0; i < sight.obstacles.num_boxes; ++i) {
      const SegmentClearance box = ClearanceOf(sight.obstacles.boxes[static_cast<std::size_t>(i)],
                                               sight.X_BC.p, sight.X_BC.p + kShare * (p_BP - sight.X_BC.p));
      if (box.clearance.distance < nearest.gap) {
        nearest = {box.clearance.distance, kShare * box.s, box.clearance.away, Vec3::Zero(), 0};
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfSight(const Sight& sight) noexcept { return NearestOf(sight).gap; }

Barrier LineOfSightBarrier(const config::ServoConfig& config, const Sight& sight,
                           const model::Mat6N& J_C) noexcept {
  constexpr double kTouch = 1e-6;  // if lines cross, the direction between them is undefined [m]
  Barrier barrier;
  if (config.guard.sight_clearance <= 0.0) {
    return barrier;
  }
  const NearSight nearest = NearestOf(sight);
  const double distance = nearest.apart.norm();
  if (!std::isfinite(nearest.gap) || !(distance > kTouch)) {
    return barrier;
  }
  const Vec3 apart = nearest.apart / distance;
  // d/dt distance = apart . (v_sight - v_link); the line of sight pivots about the fixed target.
  const Vec3 apart_C = sight.X_BC.R.transpose() * apart;
  barrier.gradient = (1.0 - nearest.s) * J_C.topRows<3>().transpose().lazyProduct(apart_C);
  if (nearest.body > 0) {
    model::LinearJacobian J_link;
    model::ComputeLinearJacobian(config.arm, sight.poses, nearest.p_BL, J_link);
    for (int i = 0; i < nearest.body; ++i) {
      barrier.gradient[i] -= J_link.col(i).dot(apart);
    }
  }
  barrier.name = hal::Limit::kFieldOfView;
  barrier.value = nearest.gap;
  barrier.margin = config.guard.sight_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
