// SPDX-License-Identifier: Apache-2.0
// Torques that bring the arm to rest at the end of a motion: a motion finished at speed causes a reflex.
#pragma once

#include <algorithm>
#include <cmath>

#include "fovea/franka/panda_limits.hpp"

namespace fovea::franka {

inline constexpr double kBrakedSpeed = 0.02;  // joints that move no faster are at rest [rad/s]

// Whether a joint moves. False if a speed is not finite: no torque follows from it. Real-time: yes.
[[nodiscard]] inline bool Moves(const Vector7& dq) noexcept {
  const bool finite = std::all_of(dq.begin(), dq.end(), [](double v) { return std::isfinite(v); });
  return finite && std::any_of(dq.begin(), dq.end(), [](double v) { return std::fabs(v) > kBrakedSpeed; });
}

// Damping torques, up to half of each joint's tau_max. The robot adds gravity. Real-time: yes.
[[nodiscard]] inline Vector7 BrakingTorque(const Vector7& dq) noexcept {
  constexpr Vector7 kDamping{40.0, 40.0, 30.0, 30.0, 8.0, 4.0, 2.0};  // [Nm s/rad]
  Vector7 tau{};
  for (std::size_t i = 0; i < tau.size(); ++i) {
    const double most = 0.5 * kPandaJoints[i].tau_max;
    tau[i] = std::clamp(-kDamping[i] * dq[i], -most, most);
  }
  return tau;
}

}  // namespace fovea::franka
