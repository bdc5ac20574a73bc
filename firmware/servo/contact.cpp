#include "fovea/servo/contact.hpp"

#include "fovea/hal/types.hpp"

namespace fovea::servo {

void ObserveContact(double gain, const model::ArmDynamics& dynamics, const model::VecN& dq,
                    const model::VecN& tau, ContactState& state) noexcept {
  constexpr double kPeriodS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
  const model::VecN p = dynamics.M.lazyProduct(dq);
  if (state.started) {
    const model::MatN dM = dynamics.M - state.M_before;
    model::VecN change = dM.lazyProduct(dq);  // C^T dq over a tick, and its other terms below
    change += kPeriodS * (tau - dynamics.Cdq + state.residual);
    state.residual += gain * (p - state.p_before - change);
  } else {
    if (state.residual.size() != dq.size()) {
      state.residual.setZero(dq.size());
    }
    state.started = true;
  }
  state.M_before = dynamics.M;
  state.p_before = p;
}

}  // namespace fovea::servo
