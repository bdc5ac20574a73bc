// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/fault_stop.hpp"

#include <algorithm>

#include "fovea/hal/types.hpp"

namespace fovea::guard {
namespace {

constexpr double kBehind = 0.2;     // a stop this much slower than expected has failed [rad/s, m/s]
constexpr double kStopShare = 0.3;  // of safety.fault_damping: the least expected damping

}  // namespace

void DampedStop(double damping, const model::ArmDynamics& dynamics, const model::VecN& dq,
                model::VecN& tau) noexcept {
  tau = dynamics.M.lazyProduct(dq);
  tau *= -damping;
}

void StopAfterFault(const config::SafetyConfig& config, const model::ArmDynamics& dynamics,
                    const model::VecN& dq, bool blind, double since_s, FaultStop& stop,
                    model::VecN& tau) noexcept {
  const double speed = dq.lpNorm<Eigen::Infinity>();
  const double falls = 1.0 - kStopShare * config.fault_damping * hal::kTickPeriodS;
  stop.speed_due = std::min(falls * stop.speed_due, speed);
  const bool in_vain = speed > stop.speed_due + kBehind;
  if (stop.stage == FaultStop::Stage::kDamped &&
      (blind || in_vain || since_s > config.brake_after_s || speed < config.brake_velocity)) {
    stop.stage = FaultStop::Stage::kLetGo;
  }
  DampedStop(config.fault_damping, dynamics, dq, tau);
  if (stop.stage != FaultStop::Stage::kDamped) {
    tau.setZero();
  }
}

void CloseBrakes(const model::VecN& tau, FaultStop& stop) noexcept {
  if (stop.stage == FaultStop::Stage::kLetGo && (tau.array() == 0.0).all()) {
    stop.stage = FaultStop::Stage::kBraked;
  }
}

}  // namespace fovea::guard
