// SPDX-License-Identifier: Apache-2.0
// Keeps the end effector in a sphere about the base (THEORY B5).
//
// h = -|p_BE| with the margin -(radius), so that h - margin is the distance from the edge. A motion along the
// edge needs |v_t|^2 / r of the deceleration for its curvature. At most half of the deceleration is reserved
// for that. The rest stops the outward motion.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// The barrier at `p_BE` [m], with the guard's edge and without gradient. `v_t2`: squared speed along the edge
// [m^2/s^2]. Inactive at the centre, where the outward direction is undefined. Real-time: yes.
[[nodiscard]] Barrier WorkspaceBarrier(const config::ServoConfig& config, const model::Vec3& p_BE,
                                       double v_t2) noexcept;

// Its gradient. `J_E_B` [3 x num_joints]: linear Jacobian of the end effector; `outward` of length 1.
// Real-time: yes.
[[nodiscard]] inline model::VecN WorkspaceGradient(const model::LinearJacobian& J_E_B,
                                                   const model::Vec3& outward) noexcept {
  return -J_E_B.transpose().lazyProduct(outward);
}

// The barrier as a row of the resolution, for the current joint velocities `dq`. Its edge is 2 mm inside the
// guard's edge, and an end effector past it returns slowly. On the guard's own edge the stop's proof would
// refuse every motion along it, because each step along a sphere leads out of the sphere. Real-time: yes.
[[nodiscard]] Barrier WorkspaceRow(const config::ServoConfig& config, const model::Vec3& p_BE,
                                   const model::LinearJacobian& J_E_B, const model::VecN& dq) noexcept;

}  // namespace fovea::barriers
