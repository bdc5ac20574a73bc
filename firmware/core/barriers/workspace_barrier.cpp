// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/workspace_barrier.hpp"

#include <algorithm>

#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
namespace {

constexpr double kCentre = 1e-6;        // [m]
constexpr double kInsideGuard = 0.002;  // [m]
constexpr double kReturnRate = 5.0;     // [1/s]
constexpr double kReturnSpeed = 0.02;   // [m/s]

}  // namespace

Barrier WorkspaceBarrier(const config::ServoConfig& config, const model::Vec3& p_BE, double v_t2) noexcept {
  Barrier barrier;
  const config::GuardConfig& guard = config.guard;
  const double radius = p_BE.norm();
  if (radius < kCentre) {
    return barrier;
  }
  barrier.value = -radius;
  barrier.margin = -(guard.workspace_radius - guard.workspace_margin);
  barrier.deceleration =
      std::max(guard.workspace_deceleration - v_t2 / radius, 0.5 * guard.workspace_deceleration);
  barrier.reaction_s = trajectory::SlowestReaction(config);
  return barrier;
}

Barrier WorkspaceRow(const config::ServoConfig& config, const model::Vec3& p_BE,
                     const model::LinearJacobian& J_E_B, const model::VecN& dq) noexcept {
  const model::Vec3 outward = p_BE / std::max(p_BE.norm(), kCentre);
  const model::Vec3 v_E = J_E_B.lazyProduct(dq);
  Barrier barrier = WorkspaceBarrier(config, p_BE, (v_E - v_E.dot(outward) * outward).squaredNorm());
  barrier.gradient = WorkspaceGradient(J_E_B, outward);
  barrier.margin += kInsideGuard;
  barrier.return_rate = kReturnRate;
  barrier.return_speed = kReturnSpeed;
  return barrier;
}

}  // namespace fovea::barriers
