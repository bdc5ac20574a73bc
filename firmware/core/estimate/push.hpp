// SPDX-License-Identifier: Apache-2.0
// Detects that something pushes the arm, from the external torques that contact.hpp estimates.
//
// Wrong masses, an unknown load and wrong friction also look like external torques, but these change only as
// fast as the arm moves. The watch follows them with the time constant kFollowS and takes the rest for
// sudden. A joint is pushed if its torque exceeds one limit in total, or a lower one suddenly. `fovea
// atlas --contact` measures what both limits detect, and how often they err.
#pragma once

#include <cstdint>

#include "firmware/core/model/arm_model.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

struct PushWatch {
  static constexpr double kFollowS = 0.2;

  std::int32_t ticks = 0;  // watched, up to kFollowS: until then all torque counts as followed
  model::VecN followed;    // [num_joints] the part that changes slowly [Nm, N]
};

// Of a joint's largest torque.
struct PushShares {
  double total = 0.0;
  double sudden = 0.0;
};

// One tick. `tau_ext` [num_joints]: external torques. Real-time: yes.
void WatchPush(const model::VecN& tau_ext, PushWatch& watch) noexcept;

// The shares of joint `i` now. Real-time: yes.
[[nodiscard]] PushShares SharesOf(const model::ArmModel& arm, const model::VecN& tau_ext,
                                  const PushWatch& watch, int i) noexcept;

// The first joint whose shares exceed `limits`, or are not finite; -1: none. Real-time: yes.
[[nodiscard]] std::int32_t PushedJoint(const model::ArmModel& arm, const PushShares& limits,
                                       const model::VecN& tau_ext, const PushWatch& watch) noexcept;

}  // namespace fovea::estimate
