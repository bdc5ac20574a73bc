// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/servo_estimate.hpp"

#include <cmath>

namespace fovea::beliefs {

void ServoEstimator::Add(const hal::TickRecord& record) {
  constexpr double kAtTheEnd = 0.999;
  if (record.tuning.result == hal::TuningResult::kTaken && record.tuning.key == config::kStampOffsetKey) {
    offset_ = record.tuning.asked;
  }
  if (record.target_known) {
    has_seen_ = true;
    late_ = {record.stamp_late_s, record.stamp_late_sigma_s};
    is_bound_ = std::fabs(late_.mean_s - offset_) >= kAtTheEnd * most_;
  }
}

}  // namespace fovea::beliefs
