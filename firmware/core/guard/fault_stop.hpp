// How the arm is stopped after a fault: damped, as long as that can be and helps; then let go, and braked.
//
// Damping needs true velocities. Nor does it stop a joint whose motor is dead or that is pushed: then the arm
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
    kLetGo,   // the torque fades out, as fast as the arm takes it
    kBraked,  // there is none any more, and the brakes close
  };
  static constexpr int kNumStages = 3;

  Stage stage = Stage::kDamped;
  double speed_due = HUGE_VAL;  // how slow the fastest joint should be by now [rad/s, m/s]
};

// tau = -damping M dq, which takes the speed away like exp(-damping t). Real-time: yes.
void DampedStop(double damping, const model::ArmDynamics& dynamics, const model::VecN& dq,
                model::VecN& tau) noexcept;

// One tick in Fault, `since_s` after it began. `blind`: the velocities `dq` [num_joints] are not to be
// believed. Writes `tau` [num_joints]. Real-time: yes.
void StopAfterFault(const config::SafetyConfig& config, const model::ArmDynamics& dynamics,
                    const model::VecN& dq, bool blind, double since_s, FaultStop& stop,
                    model::VecN& tau) noexcept;

// After the clamp: the brakes close once the torque `tau` that is sent is gone. Real-time: yes.
void CloseBrakes(const model::VecN& tau, FaultStop& stop) noexcept;

}  // namespace fovea::guard
