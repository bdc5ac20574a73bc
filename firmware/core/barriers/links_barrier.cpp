// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/links_barrier.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

// The closest approach of a link to the planes or the box of a row.
struct NearestLink {
  Clearance clearance{HUGE_VAL, Vec3::UnitZ()};
  Vec3 p_BP = Vec3::Zero();  // on the axis of the nearest body [m]
  int body = -1;
};

NearestLink NearestOfPlanes(const config::Obstacles& obstacles, const ArmBodies& bodies) noexcept {
  NearestLink nearest;
  for (int k = std::max(bodies.size - kOuterLinks, 1); k < bodies.size; ++k) {
    const PlacedCapsule& body = bodies.body[static_cast<std::size_t>(k)];
    for (int i = 0; i < obstacles.num_planes; ++i) {
      const config::Plane& plane = obstacles.planes[static_cast<std::size_t>(i)];
      for (const Vec3& end : {body.p_BA, body.p_BB}) {
        const double distance = plane.normal.dot(end) - plane.distance - body.radius;
        if (distance < nearest.clearance.distance) {
          nearest = {{distance, plane.normal}, end, k};
        }
      }
    }
  }
  return nearest;
}

// Whether the capsule may be nearer to the box than `distance`, by the ball about it.
bool MayBeNearer(const config::Box& box, const PlacedCapsule& body, double distance) noexcept {
  double away2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double p = body.middle[i];
    const double away = p > box.high[i] ? p - box.high[i] : p < box.low[i] ? box.low[i] - p : 0.0;
    away2 += away * away;
  }
  const double bound = distance + body.reach;
  return bound > 0.0 && away2 < bound * bound;
}

// The outer links, which usually are the nearest, come first.
NearestLink NearestOfBox(const config::Box& box, const ArmBodies& bodies) noexcept {
  NearestLink nearest;
  for (int k = bodies.size - 1; k >= 1; --k) {
    const PlacedCapsule& body = bodies.body[static_cast<std::size_t>(k)];
    if (!MayBeNearer(box, body, nearest.clearance.distance)) {
      continue;
    }
    SegmentClearance axis = ClearanceOf(box, body.p_BA, body.p_BB);
    axis.clearance.distance -= body.radius;
    if (axis.clearance.distance < nearest.clearance.distance) {
      nearest = {axis.clearance, axis.p_B, k};
    }
  }
  return nearest;
}

// Of row `i`.
NearestLink NearestOf(const config::Obstacles& obstacles, int i, const ArmBodies& bodies) noexcept {
  const int box = obstacles.num_planes > 0 ? i - 1 : i;
  return box < 0 ? NearestOfPlanes(obstacles, bodies)
                 : NearestOfBox(obstacles.boxes[static_cast<std::size_t>(box)], bodies);
}

}  // namespace

double ClearanceOfLinks(const config::Obstacles& obstacles, int i, const ArmBodies& bodies) noexcept {
  return NearestOf(obstacles, i, bodies).clearance.distance;
}

Barrier LinksBarrier(const config::ServoConfig& config, int i, const model::ArmPoses& poses,
                     const ArmBodies& bodies) noexcept {
  const model::ArmModel& arm = config.arm;
  const NearestLink nearest = NearestOf(config.guard.obstacles, i, bodies);
  Barrier barrier;
  if (!std::isfinite(nearest.clearance.distance)) {
    return barrier;
  }
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.p_BP, J);
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  for (int k = 0; k < nearest.body; ++k) {
    barrier.gradient[k] = J.col(k).dot(nearest.clearance.away);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.clearance.distance;
  barrier.margin = config.guard.link_clearance + 2.0 * config.guard.workspace_margin;
  barrier.deceleration = 0.5 * config.guard.workspace_deceleration;
  barrier.reaction_s = trajectory::SlowestReaction(config);
  return barrier;
}

}  // namespace fovea::barriers
