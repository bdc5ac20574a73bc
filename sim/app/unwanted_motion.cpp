#include "sim/app/unwanted_motion.hpp"

#include <algorithm>

#include "fovea/hal/types.hpp"

namespace fovea::sim {

void UnwantedMotion::Add(const Truth& truth, hal::Mode mode) {
  constexpr double kStepS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
  const Eigen::Vector3d p = truth.X_BE.translation();
  const double speed = p_before_ ? (p - *p_before_).norm() / kStepS : 0.0;
  if (mode != mode_) {
    const bool stands = mode == hal::Mode::kBoot || mode == hal::Mode::kHold || mode == hal::Mode::kFault;
    now_ = stands ? &by_mode_[hal::Name(mode)] : nullptr;
    mode_ = mode;
    p_start_ = p_before_.value_or(p);
    speed_start_ = speed_before_;
  }
  if (now_ != nullptr) {
    now_->most_mm = std::max(now_->most_mm, 1e3 * (p - p_start_).norm());
    now_->most_m_per_s = std::max(now_->most_m_per_s, speed);
    now_->gained_m_per_s = std::max(now_->gained_m_per_s, speed - speed_start_);
  }
  p_before_ = p;
  speed_before_ = speed;
}

}  // namespace fovea::sim
