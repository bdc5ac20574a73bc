// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "firmware/core/motion_laws/friction.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"

namespace fovea::motion_laws {
namespace {

// Adds one tick's error, unless the clamp cut the torque in that direction.
void Integrate(const config::MotionLawConfig& config, const MotionLawInputs& inputs, double k_i,
               const model::VecN& e, MotionLawState& state) noexcept {
  for (int i = 0; i < e.size(); ++i) {
    const model::Joint& joint = inputs.arm.joints[static_cast<std::size_t>(i)];
    const bool winds_up = state.cut[i] * e[i] > 0.0;
    if (!winds_up) {
      const double most = config.integral_torque_fraction * joint.tau_max / (k_i * inputs.dynamics.M(i, i));
      state.integral[i] = std::clamp(state.integral[i] + e[i] * hal::kTickPeriodS, -most, most);
    }
  }
}

}  // namespace

void ComputedTorque(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                    MotionLawState& state, model::VecN& tau) noexcept {
  const double k_p = config.omega_n * config.omega_n;
  const double k_v = 2.0 * config.zeta * config.omega_n;
  const double k_i = config.integral * k_p;
  const model::VecN e = inputs.reference.q - inputs.q;
  model::VecN wanted = inputs.reference.ddq + k_v * (inputs.reference.dq - inputs.dq) + k_p * e;
  if (k_i > 0.0) {
    Integrate(config, inputs, k_i, e, state);
    wanted += k_i * state.integral;
  }
  tau = inputs.dynamics.Cdq;
  tau += FrictionTorque(inputs.arm, config, inputs.reference, inputs.dq);
  tau += SpringTorque(inputs.arm, inputs.q);
  tau += inputs.dynamics.M.lazyProduct(wanted);
}

}  // namespace fovea::motion_laws
