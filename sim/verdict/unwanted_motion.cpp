// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/unwanted_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kHalf = 5;  // half of the steps over which an acceleration is computed

}  // namespace

UnwantedMotion::UnwantedMotion(StopRules rules) : rules_(std::move(rules)) {}

void UnwantedMotion::Add(const Truth& truth, hal::Mode mode) {
  const Eigen::Vector3d p = truth.X_BE.translation();
  const double speed = p_.empty() ? 0.0 : (p - p_.back()).norm() / hal::kTickPeriodS;
  if (mode != mode_) {
    const bool stands = mode == hal::Mode::kBoot || mode == hal::Mode::kHold || mode == hal::Mode::kFault;
    now_ = stands ? &by_mode_[hal::Name(mode)] : nullptr;
    mode_ = mode;
    p_start_ = p_.empty() ? p : p_.back();
    speed_start_ = speed_before_ + 0.5 * Acceleration() * TurnTime(mode);
    stop_mm_ = 1e3 * speed_start_ * StopTime(mode, truth.dq);
  }
  if (now_ != nullptr) {
    const double way_mm = 1e3 * (p - p_start_).norm();
    now_->most_mm = std::max(now_->most_mm, way_mm);
    now_->beyond_stop_mm = std::max(now_->beyond_stop_mm, way_mm - stop_mm_);
    now_->most_m_per_s = std::max(now_->most_m_per_s, speed);
    now_->gained_m_per_s = std::max(now_->gained_m_per_s, speed - speed_start_);
  }
  p_.push_back(p);
  if (p_.size() > 2 * kHalf + 1) {
    p_.pop_front();
  }
  speed_before_ = speed;
}

// The hand's mean acceleration over the last 10 ms [m/s^2].
double UnwantedMotion::Acceleration() const {
  if (p_.size() < 2 * kHalf + 1) {
    return 0.0;
  }
  constexpr double kHalfS = kHalf * hal::kTickPeriodS;
  return (p_[2 * kHalf] - 2.0 * p_[kHalf] + p_[0]).norm() / (kHalfS * kHalfS);
}

// Time to reverse the joints' accelerations under the jerk limit. In Fault, torques have no such limit: 0.
double UnwantedMotion::TurnTime(hal::Mode mode) const {
  return mode == hal::Mode::kHold ? 2.0 * rules_.ddq_max.cwiseQuotient(rules_.dddq_max).maxCoeff() : 0.0;
}

// Allowed time of a stop at constant speed, for joint velocities `dq` at the start of `mode`. In Hold, all
// joints stop together with the slowest one; at constant deceleration it travels half as far as at constant
// speed. The time to reverse the accelerations comes first.
double UnwantedMotion::StopTime(hal::Mode mode, const Eigen::VectorXd& dq) const {
  switch (mode) {
    case hal::Mode::kHold: {
      double longest_s = 0.0;
      for (Eigen::Index i = 0; i < dq.size(); ++i) {
        longest_s = std::max(longest_s, 0.5 * std::fabs(dq[i]) / rules_.ddq_max[i]);
      }
      return longest_s + TurnTime(mode);
    }
    case hal::Mode::kFault: return rules_.brake_after_s;
    case hal::Mode::kBoot:  // starts at rest
    case hal::Mode::kTrack:
    case hal::Mode::kCoast:
    case hal::Mode::kMove: break;
  }
  return 0.0;
}

}  // namespace fovea::sim
