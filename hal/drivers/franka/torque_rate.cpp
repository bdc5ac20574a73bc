// SPDX-License-Identifier: Apache-2.0
#include "fovea/franka/torque_rate.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::franka {
namespace {

constexpr double kSame = 1e-9;  // [Nm]; the robot reports a command's torque unchanged

bool AreSame(const Vector7& a, const Vector7& b) noexcept {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(std::fabs(a[i] - b[i]) <= kSame)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool TorqueRate::Limit(const Vector7& wish, const Vector7& tau_J_d, Vector7& command) noexcept {
  const Vector7 in_force = Known(tau_J_d);
  ForgetWhatCameBefore(in_force);
  bool limited = false;
  for (std::size_t i = 0; i < wish.size(); ++i) {
    double low = in_force[i];
    double high = in_force[i];
    for (std::size_t k = 0; k < num_sent_; ++k) {
      low = std::min(low, sent_[k][i]);
      high = std::max(high, sent_[k][i]);
    }
    // If they are more than two steps apart, no torque is near all of them: take the middle.
    const double least = std::min(high - step_max_[i], 0.5 * (low + high));
    const double most = std::max(low + step_max_[i], 0.5 * (low + high));
    command[i] = std::clamp(wish[i], least, most);
    limited = limited || command[i] != wish[i];
  }
  if (num_sent_ == kMost) {
    std::move(sent_.begin() + 1, sent_.end(), sent_.begin());
    --num_sent_;
  }
  sent_[num_sent_++] = command;
  return limited;
}

// Replaces values that are not finite by those of the last command.
Vector7 TorqueRate::Known(const Vector7& tau_J_d) const noexcept {
  Vector7 known = tau_J_d;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!std::isfinite(known[i])) {
      known[i] = num_sent_ > 0 ? sent_[num_sent_ - 1][i] : 0.0;
    }
  }
  return known;
}

// The robot applies commands in the order in which they were sent: drop those older than the one in force.
// That one stays, so that a later equal one is not mistaken for it.
void TorqueRate::ForgetWhatCameBefore(const Vector7& tau_J_d) noexcept {
  if (num_sent_ == 0) {
    sent_[num_sent_++] = tau_J_d;
  }
  const auto end = sent_.begin() + static_cast<std::ptrdiff_t>(num_sent_);
  const auto in_force =
      std::find_if(sent_.begin(), end, [&](const Vector7& sent) { return AreSame(sent, tau_J_d); });
  if (in_force != end) {
    num_sent_ = static_cast<std::size_t>(std::move(in_force, end, sent_.begin()) - sent_.begin());
  }
}

}  // namespace fovea::franka
