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

NearestLink NearestOf(const config::Obstacles& obstacles, int i, const ArmBodies& bodies) noexcept {
  const bool planes = i == 0 && obstacles.num_planes > 0;
  const int first = planes ? 0 : obstacles.num_planes + i - (obstacles.num_planes > 0 ? 1 : 0);
  const int end = planes ? obstacles.num_planes : first + 1;
  NearestLink nearest;
  for (int k = planes ? std::max(bodies.size - kOuterLinks, 1) : 1; k < bodies.size; ++k) {
    const PlacedCapsule& body = bodies.body[static_cast<std::size_t>(k)];
    for (int obstacle = first; obstacle < end; ++obstacle) {
      SegmentClearance axis = ClearanceOf(obstacles, obstacle, body.p_BA, body.p_BB);
      axis.clearance.distance -= body.radius;
      if (axis.clearance.distance < nearest.clearance.distance) {
        nearest = {axis.clearance, axis.p_B, k};
      }
    }
  }
  return nearest;
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
