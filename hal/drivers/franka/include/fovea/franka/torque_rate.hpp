// Keeps torque commands within one step of whatever the robot may hold when they come.
//
// On a good network that is what the answered state says. When packets are lost or late, a command that was
// sent since may have been applied meanwhile, or may never have come: the next one must be near to all of
// them.
#pragma once

#include <array>
#include <cstddef>

#include "fovea/franka/states.hpp"

namespace fovea::franka {

class TorqueRate {
 public:
  // `step_max`: the change of each joint's torque from one command that is applied to the next [Nm].
  explicit TorqueRate(const Vector7& step_max) noexcept : step_max_(step_max) {}

  // A motion begins: nothing has been sent in it.
  void Clear() noexcept { num_sent_ = 0; }

  // The torque nearest to `wish` that is within a step of `tau_J_d`, which the answered state holds, and of
  // what was sent since that was [Nm]. True when it is not `wish` itself. Where `tau_J_d` is no number, what
  // was sent last counts for it. Real-time: yes.
  bool Limit(const Vector7& wish, const Vector7& tau_J_d, Vector7& command) noexcept;

 private:
  static constexpr std::size_t kMost = 8;  // commands that may be on their way

  [[nodiscard]] Vector7 Known(const Vector7& tau_J_d) const noexcept;
  void ForgetWhatCameBefore(const Vector7& tau_J_d) noexcept;

  Vector7 step_max_;
  std::array<Vector7, kMost> sent_{};  // oldest first
  std::size_t num_sent_ = 0;
};

}  // namespace fovea::franka
