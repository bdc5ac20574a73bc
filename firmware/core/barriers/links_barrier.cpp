// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/links_barrier.hpp"

#include <algorithm>
#include <array>
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

// The distance of the ball about a capsule from the box, or how deep its middle is inside, less its radius:
// the capsule is no nearer, and no deeper.
double DistanceOfBall(const config::Box& box, const PlacedCapsule& body) noexcept {
  double away2 = 0.0;
  double most = -HUGE_VAL;  // beyond a pair of faces
  for (int i = 0; i < 3; ++i) {
    const double beyond = std::max(body.middle[i] - box.high[i], box.low[i] - body.middle[i]);
    most = std::max(most, beyond);
    away2 += beyond > 0.0 ? beyond * beyond : 0.0;
  }
  return (most > 0.0 ? std::sqrt(away2) : most) - body.reach;
}

// Of the links that are nearer than `enough`; no body if there is none. The link whose ball is the nearest
// comes first: it usually leaves nothing to look at among the others.
NearestLink NearestOfBox(const config::Box& box, const ArmBodies& bodies, double enough) noexcept {
  std::array<double, model::ArmShape::kMostBodies> ball;
  int first = 1;
  for (int k = 1; k < bodies.size; ++k) {
    const auto i = static_cast<std::size_t>(k);
    ball[i] = DistanceOfBall(box, bodies.body[i]);
    first = ball[i] < ball[static_cast<std::size_t>(first)] ? k : first;
  }
  NearestLink nearest;
  nearest.clearance.distance = enough;
  const auto consider = [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    if (!(ball[i] < nearest.clearance.distance)) {
      return;
    }
    const PlacedCapsule& body = bodies.body[i];
    SegmentClearance axis = ClearanceOf(box, body.p_BA, body.p_BB);
    axis.clearance.distance -= body.radius;
    if (axis.clearance.distance < nearest.clearance.distance) {
      nearest = {axis.clearance, axis.p_B, k};
    }
  };
  consider(first);
  for (int k = 1; k < bodies.size; ++k) {
    if (k != first) {
      consider(k);
    }
  }
  return nearest;
}

// Of row `i`.
NearestLink NearestOf(const config::Obstacles& obstacles, int i, const ArmBodies& bodies,
                      double enough) noexcept {
  const int box = obstacles.num_planes > 0 ? i - 1 : i;
  return box < 0 ? NearestOfPlanes(obstacles, bodies)
                 : NearestOfBox(obstacles.boxes[static_cast<std::size_t>(box)], bodies, enough);
}

}  // namespace

double ClearanceOfLinks(const config::Obstacles& obstacles, int i, const ArmBodies& bodies,
                        double enough) noexcept {
  return NearestOf(obstacles, i, bodies, enough).clearance.distance;
}

Barrier LinksBarrier(const config::ServoConfig& config, int i, const model::ArmPoses& poses,
                     const ArmBodies& bodies) noexcept {
  const model::ArmModel& arm = config.arm;
  const NearestLink nearest = NearestOf(config.guard.obstacles, i, bodies, HUGE_VAL);
  Barrier barrier;
  if (!std::isfinite(nearest.clearance.distance)) {
    return barrier;
  }
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  for (int k = 0; k < nearest.body; ++k) {
    barrier.gradient[k] = model::PointVelocity(arm, poses, k, nearest.p_BP).dot(nearest.clearance.away);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.clearance.distance;
  barrier.margin = config.guard.link_clearance + 2.0 * config.guard.workspace_margin;
  barrier.deceleration = 0.5 * config.guard.workspace_deceleration;
  barrier.reaction_s = trajectory::SlowestReaction(config);
  return barrier;
}

}  // namespace fovea::barriers
