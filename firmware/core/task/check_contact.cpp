// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/check_contact.hpp"

#include <cmath>

#include "firmware/core/motion_laws/friction.hpp"

namespace fovea::task {
namespace {

// The first joint whose external torque exceeds its limit; -1: none.
std::int32_t PushedJoint(const config::ServoConfig& config, const model::VecN& residual) noexcept {
  for (int i = 0; i < residual.size(); ++i) {
    const double most =
        config.safety.contact_torque_fraction * config.arm.joints[static_cast<std::size_t>(i)].tau_max;
    if (!(std::fabs(residual[i]) <= most)) {
      return i;
    }
  }
  return -1;
}

}  // namespace

void CheckContact(const config::ServoConfig& config, const ContactScene& scene, ServoState& state,
                  InputCheck& check) noexcept {
  if (!scene.sound || !scene.drives) {
    state.contact.started = false;
  } else {
    estimate::ObserveContact(config.safety.contact_gain, state.dynamics, state.dq,
                             state.tau_applied - motion_laws::SpringTorque(config.arm, state.q),
                             state.contact);
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
    if (const std::int32_t pushed = PushedJoint(config, state.contact.residual); pushed >= 0) {
      check = {hal::Fault::kContact, pushed};
    }
  }
}

}  // namespace fovea::task
