// The end effector stays in a sphere about the base (THEORY B5).
//
// Its quantity is h = -|p_BE|: what is left to the edge is h less its margin, -(radius). Along the edge the
// centripetal share of the deceleration is spent, |v_t|^2 / r, and at most half of it may be: the rest stops
// the outward motion.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// Of the end effector at `p_BE` [m], with the edge as the guard keeps it, without its gradient. `v_t2`:
// square of its speed along the edge [m^2/s^2]. No barrier at the centre, where every direction leads out and
// none is near the edge. Real-time: yes.
[[nodiscard]] Barrier WorkspaceBarrier(const config::ServoConfig& config, const model::Vec3& p_BE,
                                       double v_t2) noexcept;

// Its gradient, moving by `J_E_B` [3 x num_joints]; `outward` of length 1. Real-time: yes.
[[nodiscard]] inline model::VecN WorkspaceGradient(const model::LinearJacobian& J_E_B,
                                                   const model::Vec3& outward) noexcept {
  return -J_E_B.transpose().lazyProduct(outward);
}

// As a row of the resolution, at present with the joint velocities `dq`: the edge is the guard's less 2 mm,
// and what is past it goes slowly back. On the guard's own edge its proof would let nothing pass that moves
// along it, since every step along a sphere leads out of it. Real-time: yes.
[[nodiscard]] Barrier WorkspaceRow(const config::ServoConfig& config, const model::Vec3& p_BE,
                                   const model::LinearJacobian& J_E_B, const model::VecN& dq) noexcept;

}  // namespace fovea::barriers
