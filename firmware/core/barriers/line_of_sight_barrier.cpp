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

// A line of sight from the camera.
struct SightLine {
  Vec3 p_BC = Vec3::Zero();  // the camera, in B [m]
  Vec3 way = Vec3::Zero();   // to the point that it sees, in B [m]
  double length2 = 0.0;      // of `way`, squared [m^2]

  SightLine(const Vec3& p_BC_, const Vec3& p_BP) noexcept
      : p_BC(p_BC_), way(p_BP - p_BC_), length2(way.squaredNorm()) {}

  // The squared distance of a point from the line [m^2].
  [[nodiscard]] double Away2(const Vec3& p_B) const noexcept {
    const Vec3 from_camera = p_B - p_BC;
    const double along = from_camera.dot(way);
    const double s = along <= 0.0 ? 0.0 : along >= length2 ? 1.0 : along / length2;
    return (from_camera - s * way).squaredNorm();
  }
};

// How many links may come into the view: not those that hold the camera.
int CountLinks(const Sight& sight) noexcept {
  return std::max(sight.bodies.size - model::ArmShape::kNeighbours - 1, 0);
}

// A distance that some link surely has from a line of sight: of the one that seems the nearest. Links whose
// ball about their middle is further need no closer look.
double SomeGap(const Sight& sight, const SightLine& line) noexcept {
  double least = HUGE_VAL;
  int seems = -1;
  for (int i = 0; i < CountLinks(sight); ++i) {
    const PlacedCapsule& link = sight.bodies.body[static_cast<std::size_t>(i)];
    if (const double gap = std::sqrt(line.Away2(link.middle)) - link.reach - kHousing; gap < least) {
      least = gap;
      seems = i;
    }
  }
  if (seems < 0) {
    return HUGE_VAL;
  }
  const PlacedCapsule& link = sight.bodies.body[static_cast<std::size_t>(seems)];
  const Vec3 p_BP = line.p_BC + line.way;
  return model::NearestOfSegments(line.p_BC, p_BP, link.p_BA, link.p_BB).distance - link.radius - kHousing;
}

// Over all links, boxes and lines of sight.
NearSight NearestOf(const Sight& sight) noexcept {
  constexpr double kShare = 0.9;      // of a line, from the camera, that boxes must keep clear
  constexpr double kRounding = 1e-9;  // [m]
  NearSight nearest;
  double enough = HUGE_VAL;  // the nearest link has this gap at most
  for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
    const Vec3 p_BP = sight.X_BO * sight.outline.p_OP[k];
    const SightLine line(sight.X_BC.p, p_BP);
    enough = k == 0 ? SomeGap(sight, line) : enough;
    for (int i = 0; i < CountLinks(sight); ++i) {
      const PlacedCapsule& link = sight.bodies.body[static_cast<std::size_t>(i)];
      const double apart = std::min(enough, nearest.gap) + link.reach + kHousing + kRounding;
      if (apart > 0.0 && line.Away2(link.middle) > apart * apart) {
        continue;  // the link's ball is further
      }
      const model::SegmentPair axes = model::NearestOfSegments(sight.X_BC.p, p_BP, link.p_BA, link.p_BB);
      const double gap = axes.distance - link.radius - kHousing;
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
