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

}  // namespace fovea::model
