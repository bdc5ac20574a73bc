// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/check_contact.hpp"

#include "firmware/core/motion_laws/friction.hpp"

namespace fovea::task {
namespace {

// The torques in force that move the arm of the model: without those that hold its springs, and without those
// that hold the part of the load that only the servo knows.
model::VecN MovingTorque(const config::ServoConfig& config, const ServoState& state) noexcept {
  model::VecN tau = state.tau_applied - motion_laws::SpringTorque(config.arm, state.q);
  if (config.load.offset != 0.0) {
    tau -= model::HoldingTorque(config.arm, state.poses, config::OffsetOf(config.load));
  }
  return tau;
}

}  // namespace

void CheckContact(const config::ServoConfig& config, const ContactScene& scene, ServoState& state,
                  InputCheck& check) noexcept {
  if (!scene.sound || !scene.drives) {
    state.contact.started = false;
  } else {
    estimate::ObserveContact(config.safety.contact_gain, state.dynamics, state.dq,
                             MovingTorque(config, state), state.contact);
    estimate::WatchPush(state.contact.residual, state.push);
  }
  if (!scene.drives) {
    state.push = estimate::PushWatch{};
  }
  if (!scene.sound) {
    return;
  }
  const std::int32_t hangs = estimate::WatchEncoders(
      config, {state.q, state.dq, state.dynamics, state.contact.residual, state.reference.q, scene.drives},
      state.encoders);
  state.blind = hangs >= 0;
  if (check.fault != hal::Fault::kNone) {
    return;
  }
  if (state.blind) {
    check = {hal::Fault::kArmStale, hangs};
  } else if (scene.drives) {
    const estimate::PushShares limits{config.safety.contact_torque_fraction,
                                      config.safety.contact_sudden_fraction};
    const std::int32_t pushed = estimate::PushedJoint(config.arm, limits, state.contact.residual, state.push);
    if (pushed >= 0) {
      check = {hal::Fault::kContact, pushed};
    }
  }
}

}  // namespace fovea::task
