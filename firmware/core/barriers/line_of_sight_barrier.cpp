// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/line_of_sight_barrier.hpp"

#include <algorithm>
#include <array>
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

// The links' distances from the line of sight to O's origin. All lines of sight begin at the camera, so none
// is further from this one than its end is from O: most links are too far from all of them.
struct Links {
  std::array<double, model::ArmShape::kMostBodies> away2{};  // of the links' middles, squared [m^2]
  double spread = 0.0;                                       // of the lines' ends about O [m]

  explicit Links(const Sight& sight) noexcept {
    const Vec3 line = sight.X_BO.p - sight.X_BC.p;
    const double length2 = line.squaredNorm();
    for (std::size_t i = 0; i < static_cast<std::size_t>(sight.bodies.size); ++i) {
      const Vec3 middle = sight.bodies.body[i].middle - sight.X_BC.p;
      const double s = length2 > 0.0 ? std::clamp(middle.dot(line) / length2, 0.0, 1.0) : 0.0;
      away2[i] = (middle - s * line).squaredNorm();
    }
    double spread2 = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
      spread2 = std::max(spread2, sight.outline.p_OP[k].squaredNorm());
    }
    spread = std::sqrt(spread2);
  }

  // True if no line of sight comes nearer to link `i`, whose ball reaches so far, than `gap`.
  [[nodiscard]] bool AreFurther(std::size_t i, double reach, double gap) const noexcept {
    const double apart = gap + reach + spread;
    return apart > 0.0 && away2[i] > apart * apart;
  }
};

// Over all links, boxes and lines of sight.
NearSight NearestOf(const Sight& sight) noexcept {
  constexpr double kShare = 0.9;  // of a line, from the camera, that boxes must keep clear
  const Links links(sight);
  NearSight nearest;
  for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
    const Vec3 p_BP = sight.X_BO * sight.outline.p_OP[k];
    for (int i = 0; i + model::ArmShape::kNeighbours + 1 < sight.bodies.size; ++i) {
      const auto body = static_cast<std::size_t>(i);
      const PlacedCapsule& link = sight.bodies.body[body];
      if (links.AreFurther(body, link.reach, nearest.gap)) {
        continue;
      }
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
  for (int i = 0; i < nearest.body; ++i) {
    barrier.gradient[i] -= model::PointVelocity(config.arm, sight.poses, i, nearest.p_BL).dot(apart);
  }
  barrier.name = hal::Limit::kFieldOfView;
  barrier.value = nearest.gap;
  barrier.margin = config.guard.sight_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
