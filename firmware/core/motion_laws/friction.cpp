// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/motion_laws/friction.hpp"

#include <cmath>

namespace fovea::motion_laws {

double SmoothSign(double v, double width) noexcept { return v / std::sqrt(v * v + width * width); }

model::VecN FrictionTorque(const model::ArmModel& arm, const config::MotionLawConfig& config,
                           const trajectory::Reference& reference, const model::VecN& dq) noexcept {
  model::VecN tau(dq.size());
  const double slow2 = config.friction_slow * config.friction_slow;
  for (int i = 0; i < dq.size(); ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double measured = dq[i] * dq[i] / (dq[i] * dq[i] + slow2);  // weight of the measured speed
    const double v = reference.dq[i] + measured * (dq[i] - reference.dq[i]);
    tau[i] = config.friction_compensation *
             (joint.viscous * dq[i] + joint.coulomb * SmoothSign(v, config.friction_width));
  }
  return tau;
}

model::VecN SpringTorque(const model::ArmModel& arm, const model::VecN& q) noexcept {
  model::VecN tau(q.size());
  for (int i = 0; i < q.size(); ++i) {
    tau[i] = arm.joints[static_cast<std::size_t>(i)].spring * q[i];
  }
  return tau;
}

}  // namespace fovea::motion_laws
