// SPDX-License-Identifier: Apache-2.0
// The laws with a spring and a damper on each joint, and Float.
#include <cmath>

#include "firmware/core/motion_laws/friction.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"

namespace fovea::motion_laws {

void PdLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs, MotionLawState& /*state*/,
           model::VecN& tau) noexcept {
  tau = FrictionTorque(inputs.arm, config, inputs.reference, inputs.dq);
  for (int i = 0; i < tau.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    tau[i] += config.k_p[k] * (inputs.reference.q[i] - inputs.q[i]) +
              config.k_v[k] * (inputs.reference.dq[i] - inputs.dq[i]);
  }
}

void JointImpedance(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                    MotionLawState& /*state*/, model::VecN& tau) noexcept {
  tau = inputs.dynamics.Cdq;
  tau += FrictionTorque(inputs.arm, config, inputs.reference, inputs.dq);
  tau += SpringTorque(inputs.arm, inputs.q);
  tau += inputs.dynamics.M.lazyProduct(inputs.reference.ddq);
  for (int i = 0; i < tau.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double k_v = config.damp_by_inertia
                           ? 2.0 * config.zeta * std::sqrt(config.k_p[k] * inputs.dynamics.M(i, i))
                           : config.k_v[k];
    tau[i] +=
        config.k_p[k] * (inputs.reference.q[i] - inputs.q[i]) + k_v * (inputs.reference.dq[i] - inputs.dq[i]);
  }
}

void Float(const config::MotionLawConfig& /*config*/, const MotionLawInputs& inputs,
           MotionLawState& /*state*/, model::VecN& tau) noexcept {
  tau.setZero(inputs.q.size());
}

}  // namespace fovea::motion_laws
