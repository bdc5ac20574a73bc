// SPDX-License-Identifier: Apache-2.0
// Keeps torque commands within one step of every torque that the robot may apply when they arrive.
//
// On a good network, that is the torque in the answered state. If packets are lost or late, the robot may or
// may not have applied the commands sent since: the next one must be near all of them.
#pragma once

#include <array>
#include <cstddef>

#include "fovea/franka/states.hpp"

namespace fovea::franka {

class TorqueRate {
 public:
  // `step_max`: the largest change of each joint's torque from one applied command to the next [Nm].
  explicit TorqueRate(const Vector7& step_max) noexcept : step_max_(step_max) {}

  // At the start of a motion: nothing has been sent in it.
  void Clear() noexcept { num_sent_ = 0; }

  // Sets `command` to the torque nearest to `wish` that is within a step of `tau_J_d`, from the answered
  // state, and of the commands sent after it [Nm]. True if it differs from `wish`. Where `tau_J_d` is not
  // finite, the last command replaces it. Real-time: yes.
  bool Limit(const Vector7& wish, const Vector7& tau_J_d, Vector7& command) noexcept;

 private:
  static constexpr std::size_t kMost = 8;  // commands that may be in transit

  [[nodiscard]] Vector7 Known(const Vector7& tau_J_d) const noexcept;
  void ForgetWhatCameBefore(const Vector7& tau_J_d) noexcept;

  Vector7 step_max_;
  std::array<Vector7, kMost> sent_{};  // oldest first
  std::size_t num_sent_ = 0;
};

}  // namespace fovea::franka
