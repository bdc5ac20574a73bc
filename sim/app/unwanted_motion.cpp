#include "sim/app/unwanted_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {

UnwantedMotion::UnwantedMotion(StopRules rules) : rules_(std::move(rules)) {}

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
    stop_mm_ = stands ? 1e3 * speed_start_ * StopTime(mode, truth.dq) : 0.0;
  }
  if (now_ != nullptr) {
    const double way_mm = 1e3 * (p - p_start_).norm();
    now_->most_mm = std::max(now_->most_mm, way_mm);
    now_->beyond_stop_mm = std::max(now_->beyond_stop_mm, way_mm - stop_mm_);
    now_->most_m_per_s = std::max(now_->most_m_per_s, speed);
    now_->gained_m_per_s = std::max(now_->gained_m_per_s, speed - speed_start_);
  }
  p_before_ = p;
  speed_before_ = speed;
}

// For so long an arm whose joints move by `dq` may go on at the speed that it has, where the servo is in
// `mode` now. In Hold all joints stop in step with the one that takes longest, whose way at an even
// deceleration is half of that; before, its acceleration may have to be turned round.
double UnwantedMotion::StopTime(hal::Mode mode, const Eigen::VectorXd& dq) const {
  switch (mode) {
    case hal::Mode::kHold: {
      double longest_s = 0.0;
      for (Eigen::Index i = 0; i < dq.size(); ++i) {
        longest_s = std::max(longest_s, 0.5 * std::fabs(dq[i]) / rules_.ddq_max[i] +
                                            2.0 * rules_.ddq_max[i] / rules_.dddq_max[i]);
      }
      return longest_s;
    }
    case hal::Mode::kFault: return rules_.brake_after_s;
    case hal::Mode::kBoot:  // begins at rest
    case hal::Mode::kTrack:
    case hal::Mode::kCoast:
    case hal::Mode::kMove: break;
  }
  return 0.0;
}

}  // namespace fovea::sim
