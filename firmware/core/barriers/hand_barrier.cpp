// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/hand_barrier.hpp"

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {

Barrier HandBarrier(const config::ServoConfig& config, int obstacle, const model::ArmPoses& poses) noexcept {
  const config::GuardConfig& guard = config.guard;
  const HandClearance hand = ClearanceOf(guard.obstacles, obstacle, guard.hand, poses.X_BE);
  model::LinearJacobian J;
  model::ComputeLinearJacobian(config.arm, poses, hand.p_BP, J);
  Barrier barrier;
  barrier.name = hal::Limit::kObstacle;
  barrier.value = hand.clearance.distance;
  barrier.gradient = J.transpose().lazyProduct(hand.clearance.away);
  barrier.margin = 2.0 * guard.workspace_margin;
  barrier.deceleration = 0.5 * guard.workspace_deceleration;
  barrier.reaction_s = trajectory::SlowestReaction(config);
  return barrier;
}

}  // namespace fovea::barriers
