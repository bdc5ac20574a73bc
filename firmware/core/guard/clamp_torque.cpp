// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/clamp_torque.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::guard {

ClampResult ClampTorque(const model::ArmModel& arm, const config::SafetyConfig& config,
                        const model::VecN& tau_applied, model::VecN& tau) noexcept {
  ClampResult result;
  for (int i = 0; i < tau.size(); ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double range = config.torque_fraction * joint.tau_max;
    const double step = config.torque_rate_fraction * joint.dtau_max * hal::kTickPeriodS;
    double wanted = tau[i];
    if (!std::isfinite(wanted)) {
      wanted = 0.0;
      result.finite = false;
    }
    double allowed = std::min(std::max(wanted, -range), range);
    if (allowed != wanted) {
      result.limits |= hal::Bit(hal::Limit::kTorque);
    }
    const double change = allowed - tau_applied[i];
    if (std::fabs(change) > step) {
      allowed = tau_applied[i] + std::copysign(step, change);
      result.limits |= hal::Bit(hal::Limit::kTorqueRate);
    }
    tau[i] = std::min(std::max(allowed, -range), range);
  }
  return result;
}

}  // namespace fovea::guard
