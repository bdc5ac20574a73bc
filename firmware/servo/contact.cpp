#include "fovea/servo/contact.hpp"

#include <algorithm>

#include "fovea/hal/types.hpp"

namespace fovea::servo {
namespace {

constexpr double kPeriodS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
constexpr double kLayDownS = 0.25;  // a load is taken up and laid down within so long
constexpr std::int32_t kStillTicks =
    20;  // a joint that has not gone a step of its encoder for so long stands

}  // namespace

void ContactState::Reset(int num_joints, bool carries) noexcept {
  started = false;
  residual.setZero(num_joints);
  load.setZero(num_joints);
  carried = carries ? 1.0 : 0.0;
}

void ObserveContact(double gain, const model::ArmDynamics& dynamics, const model::VecN& dq,
                    const model::VecN& tau, ContactState& state) noexcept {
  const model::VecN p = dynamics.M.lazyProduct(dq);
  if (state.started) {
    model::VecN change = p - state.M_before.lazyProduct(dq);  // C^T dq over a tick, its other terms below
    change += kPeriodS * (tau - dynamics.Cdq + state.residual);
    state.residual += gain * (p - state.p_before - change);
  } else {
    state.started = true;
  }
  state.M_before = dynamics.M;
  state.p_before = p;
}

void CarryLoad(const LoadInputs& now, ContactState& state, model::VecN& tau) noexcept {
  constexpr double kStep = kPeriodS / kLayDownS;
  state.carried = now.stands ? std::min(state.carried + kStep, 1.0) : std::max(state.carried - kStep, 0.0);
  if (state.carried <= 0.0) {
    return;
  }
  for (int i = 0; i < tau.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (now.encoders.joints[k].ticks < kStillTicks) {
      const double free = now.stiction * now.arm.joints[k].coulomb;
      const double push = state.residual[i];
      state.load[i] = push - std::clamp(push, -free, free);
    }
    tau[i] -= state.carried * state.load[i];
  }
}

}  // namespace fovea::servo
