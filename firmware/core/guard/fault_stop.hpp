// SPDX-License-Identifier: Apache-2.0
// Stops the arm after a fault: damps it while that is possible and helps, then removes the torque and brakes.
//
// Damping needs true velocities. It cannot stop a joint that is pushed or whose motor is dead: the arm then
// gets faster again, or no slower, and only the brakes are left.
#pragma once

#include <cmath>
#include <cstdint>

#include "firmware/core/config/safety_config.hpp"
#include "firmware/core/model/dynamics.hpp"

namespace fovea::guard {

struct FaultStop {
  enum class Stage : std::uint8_t {
    kDamped,  // each joint is damped
    kLetGo,   // the torque fades out at the arm's rate limit
    kBraked,  // the torque is zero, and the brakes close
  };
  static constexpr int kNumStages = 3;

  Stage stage = Stage::kDamped;
  double speed_due = HUGE_VAL;  // expected speed of the fastest joint by now [rad/s, m/s]
};

// tau = -damping M dq, which makes the speed decay like exp(-damping t). Real-time: yes.
void DampedStop(double damping, const model::ArmDynamics& dynamics, const model::VecN& dq,
                model::VecN& tau) noexcept;

// One tick in Fault, `since_s` after it began. `blind`: the velocities `dq` [num_joints] cannot be trusted.
// Writes `tau` [num_joints]. Real-time: yes.
void StopAfterFault(const config::SafetyConfig& config, const model::ArmDynamics& dynamics,
                    const model::VecN& dq, bool blind, double since_s, FaultStop& stop,
                    model::VecN& tau) noexcept;

// Call after the clamp. The brakes close once the torque `tau` that is sent is zero. Real-time: yes.
void CloseBrakes(const model::VecN& tau, FaultStop& stop) noexcept;

}  // namespace fovea::guard
