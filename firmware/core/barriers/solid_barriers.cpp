// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/solid_barriers.hpp"

#include <algorithm>

#include "firmware/core/barriers/hand_barrier.hpp"
#include "firmware/core/barriers/links_barrier.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/barriers/workspace_barrier.hpp"

namespace fovea::barriers {
namespace {

// When the arm slides along itself, the resolution's rows are almost on their boundary. The stop's proof
// therefore allows this much less clearance [m].
constexpr double kSelfRoom = 0.01;

// Links are as good as free of a box that is further than its margin by this distance: a stop then looks at
// the box again when the arm can have come that far [m].
constexpr double kFar = 0.5;

}  // namespace

SolidBarriers::SolidBarriers(const config::ServoConfig& config) noexcept
    : config_(config),
      num_hand_(CountObstacles(config.guard.obstacles)),
      num_links_(CountLinkRows(config.guard.obstacles)),
      self_(config.guard.self_clearance > 0.0) {}

SolidBarriers::Kind SolidBarriers::KindOf(int i) const noexcept {
  if (i <= num_hand_) {
    return i == 0 ? Kind::kWorkspace : Kind::kHand;
  }
  return i <= num_hand_ + num_links_ ? Kind::kLinks : Kind::kSelf;
}

hal::Limit SolidBarriers::NameOf(int i) const noexcept {
  return KindOf(i) == Kind::kWorkspace ? hal::Limit::kWorkspace : hal::Limit::kObstacle;
}

double SolidBarriers::ValueOf(int i, const model::ArmPoses& poses, const ArmBodies& bodies) const noexcept {
  const config::GuardConfig& guard = config_.guard;
  switch (KindOf(i)) {
    case Kind::kWorkspace: return -poses.X_BE.p.norm();
    case Kind::kHand: return ClearanceOf(guard.obstacles, i - 1, guard.hand, poses.X_BE).clearance.distance;
    case Kind::kLinks:
      return ClearanceOfLinks(guard.obstacles, i - 1 - num_hand_, bodies, StopMarginOf(i) + kFar);
    case Kind::kSelf: break;
  }
  return SelfClearance(config_.arm, bodies);
}

double SolidBarriers::StopMarginOf(int i) const noexcept {
  const config::GuardConfig& guard = config_.guard;
  switch (KindOf(i)) {
    case Kind::kWorkspace: return -(guard.workspace_radius - guard.workspace_margin);
    case Kind::kHand: return guard.workspace_margin;
    case Kind::kLinks: return guard.link_clearance + guard.workspace_margin;
    case Kind::kSelf: break;
  }
  return std::max(guard.self_clearance - kSelfRoom, 0.0);
}

Barrier SolidBarriers::RowOf(int i, const Scene& scene) const noexcept {
  switch (KindOf(i)) {
    case Kind::kWorkspace: return WorkspaceRow(config_, scene.poses.X_BE.p, scene.J_E_B, scene.dq);
    case Kind::kHand: return HandBarrier(config_, i - 1, scene.poses);
    case Kind::kLinks: return LinksBarrier(config_, i - 1 - num_hand_, scene.poses, scene.bodies);
    case Kind::kSelf: break;
  }
  return SelfClearanceBarrier(config_, scene.poses, scene.bodies);
}

double ClearanceOfArm(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept {
  const config::GuardConfig& guard = config.guard;
  const ArmBodies bodies = PlaceBodies(config.arm, poses);
  double clearance = HUGE_VAL;
  for (int i = 0; i < CountLinkRows(guard.obstacles); ++i) {
    clearance = std::min(clearance, ClearanceOfLinks(guard.obstacles, i, bodies, HUGE_VAL));
  }
  for (int i = 0; i < CountObstacles(guard.obstacles); ++i) {
    clearance =
        std::min(clearance, ClearanceOf(guard.obstacles, i, guard.hand, poses.X_BE).clearance.distance);
  }
  return clearance;
}

}  // namespace fovea::barriers
