// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/links_barrier.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

// The closest approach of a link and a plane.
struct NearestPlane {
  Clearance clearance{HUGE_VAL, Vec3::UnitZ()};
  Vec3 p_BP = Vec3::Zero();  // end of the nearest body's axis [m]
  int body = -1;
};

NearestPlane NearestOfPlanes(const config::GuardConfig& guard, const ArmBodies& bodies) noexcept {
  const config::Obstacles& obstacles = guard.obstacles;
  NearestPlane nearest;
  for (int k = std::max(bodies.size - kOuterLinks, 1); k < bodies.size; ++k) {
    const PlacedCapsule& body = bodies.body[static_cast<std::size_t>(k)];
    for (int i = 0; i < obstacles.num_planes; ++i) {
      for (const Vec3& end : {body.p_BA, body.p_BB}) {
        Clearance clearance = ClearanceOf(obstacles, i, end);
        clearance.distance -= body.radius;
        if (clearance.distance < nearest.clearance.distance) {
          nearest = {clearance, end, k};
        }
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfPlanes(const config::GuardConfig& guard, const ArmBodies& bodies) noexcept {
  return NearestOfPlanes(guard, bodies).clearance.distance;
}

Barrier LinksBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                     const ArmBodies& bodies) noexcept {
  const model::ArmModel& arm = config.arm;
  const NearestPlane nearest = NearestOfPlanes(config.guard, bodies);
  Barrier barrier;
  if (!std::isfinite(nearest.clearance.distance)) {
    return barrier;
  }
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.p_BP, J);
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  for (int i = 0; i < nearest.body; ++i) {
    barrier.gradient[i] = J.col(i).dot(nearest.clearance.away);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.clearance.distance;
  barrier.margin = config.guard.link_clearance + 2.0 * config.guard.workspace_margin;
  barrier.deceleration = 0.5 * config.guard.workspace_deceleration;
  barrier.reaction_s = trajectory::SlowestReaction(config);
  return barrier;
}

}  // namespace fovea::barriers
