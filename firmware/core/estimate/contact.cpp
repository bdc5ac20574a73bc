// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/contact.hpp"

#include <algorithm>

#include "fovea/hal/types.hpp"

namespace fovea::estimate {
namespace {

constexpr double kChangeS = 0.25;  // the compensation fades in and out in this time [s]
// Compensated share of the observed torque. If a joint's reading does not follow its motion, the observer
// takes the servo's own torque for an external one. Full compensation would then raise the torque without
// end; this share keeps it bounded. Against a real load the arm is stiffer by 1 / (1 - kShare).
constexpr double kShare = 0.75;

}  // namespace

void ContactState::Reset(int num_joints, bool carries) noexcept {
  started = false;
  residual.setZero(num_joints);
  carried = carries ? 1.0 : 0.0;
}

void ObserveContact(double gain, const model::ArmDynamics& dynamics, const model::VecN& dq,
                    const model::VecN& tau, ContactState& state) noexcept {
  const model::VecN p = dynamics.M.lazyProduct(dq);
  if (state.started) {
    model::VecN change = p - state.M_before.lazyProduct(dq);  // dM/dt dq over a tick; the other terms follow
    change += hal::kTickPeriodS * (tau - dynamics.Cdq + state.residual);
    state.residual += gain * (p - state.p_before - change);
  } else {
    state.started = true;
  }
  state.M_before = dynamics.M;
  state.p_before = p;
}

void CarryLoad(const CarriedLoad& load, ContactState& state, model::VecN& tau) noexcept {
  constexpr double kStep = hal::kTickPeriodS / kChangeS;
  state.carried = load.stands ? std::min(state.carried + kStep, 1.0) : std::max(state.carried - kStep, 0.0);
  for (int i = 0; state.carried > 0.0 && i < tau.size(); ++i) {
    const model::Joint& joint = load.arm.joints[static_cast<std::size_t>(i)];
    const double free = load.stiction_fraction * joint.coulomb;
    const double most = load.torque_fraction * joint.tau_max;
    const double push = state.residual[i];
    tau[i] -= state.carried * std::clamp(kShare * (push - std::clamp(push, -free, free)), -most, most);
  }
}

}  // namespace fovea::estimate
