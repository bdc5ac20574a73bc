// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/load.hpp"

namespace fovea::model {
namespace {

// What a mass at `d` from a point adds to the inertia about that point (Steiner).
Mat3 OfPointMass(double mass, const Vec3& d) noexcept {
  return mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
}

}  // namespace

LinkInertia Join(const LinkInertia& a, const LinkInertia& b) noexcept {
  LinkInertia sum;
  sum.mass = a.mass + b.mass;
  sum.p_LiCom = (a.mass * a.p_LiCom + b.mass * b.p_LiCom) / sum.mass;
  sum.I_Com_Li = a.I_Com_Li + OfPointMass(a.mass, a.p_LiCom - sum.p_LiCom) + b.I_Com_Li +
                 OfPointMass(b.mass, b.p_LiCom - sum.p_LiCom);
  return sum;
}

void Attach(const Load& load, ArmModel& arm) noexcept {
  LinkInertia& last = arm.links[static_cast<std::size_t>(arm.num_joints - 1)];
  const Pose& X_LnE = arm.X_LnE;
  last = Join(last, {load.mass, X_LnE * load.p_ECom, X_LnE.R * load.I_Com_E * X_LnE.R.transpose()});
}

// With the point's velocity J dq, its mass has the kinetic energy m/2 |J dq|^2, and needs the force
// m (J ddq + dJ/dt dq - g).
void AddPointMass(const ArmModel& arm, const ArmPoses& poses, const VecN& dq, const PointMass& extra,
                  ArmDynamics& dynamics) noexcept {
  const Vec3 r_B = poses.X_BE.R * extra.p_E;
  LinearJacobian J;
  ComputeLinearJacobian(arm, poses, poses.X_BE.p + r_B, J);
  const Vec6 bias = BiasAcceleration(arm, poses, dq);
  const Vec3 w = AngularVelocity(arm, poses, dq);
  const Vec3 a = bias.head<3>() + Cross(bias.tail<3>(), r_B) + Cross(w, Cross(w, r_B));
  dynamics.M += extra.mass * J.transpose().lazyProduct(J);
  dynamics.Cdq += extra.mass * J.transpose().lazyProduct(a);
  dynamics.g -= extra.mass * J.transpose().lazyProduct(arm.g_B);
}

VecN HoldingTorque(const ArmModel& arm, const ArmPoses& poses, const PointMass& extra) noexcept {
  LinearJacobian J;
  ComputeLinearJacobian(arm, poses, poses.X_BE * extra.p_E, J);
  return -extra.mass * J.transpose().lazyProduct(arm.g_B);
}

}  // namespace fovea::model
