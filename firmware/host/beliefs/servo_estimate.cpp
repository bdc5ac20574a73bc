// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/servo_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::beliefs {
namespace {

constexpr double kAtTheEnd = 0.999;
constexpr std::int64_t kWatchedNs = 1'000'000'000;
constexpr std::int64_t kBetweenNs = 20'000'000;  // two samples
constexpr double kMovedM = 0.05;

}  // namespace

void ServoEstimator::Forget() {
  recent_.clear();
  has_settled_ = false;
  places_.setEmpty();
}

void ServoEstimator::Add(const hal::TickRecord& record) {
  if (record.tuning.result == hal::TuningResult::kTaken && record.tuning.key == config::kStampOffsetKey) {
    offset_ = record.tuning.asked;
  }
  if (record.mode == hal::Mode::kHold && record.hold_reason == hal::HoldReason::kEyeDoubted) {
    Forget();
    return;
  }
  if (!record.target_known) {
    recent_.clear();
    return;
  }
  const std::int64_t now_ns = record.stamp_ns;
  if (recent_.empty()) {
    known_since_ns_ = now_ns;
  }
  if (recent_.empty() || now_ns - recent_.back().stamp_ns >= kBetweenNs) {
    recent_.push_back({now_ns, record.stamp_late_s});
  }
  while (now_ns - recent_.front().stamp_ns > kWatchedNs) {
    recent_.pop_front();
  }
  if (now_ns - known_since_ns_ < kWatchedNs) {
    return;
  }
  const auto [least, most] = std::minmax_element(
      recent_.begin(), recent_.end(), [](const Sample& a, const Sample& b) { return a.mean_s < b.mean_s; });
  late_ = {record.stamp_late_s, std::max(record.stamp_late_sigma_s, 0.5 * (most->mean_s - least->mean_s))};
  is_bound_ = std::fabs(late_.mean_s - offset_) >= kAtTheEnd * most_;
  has_settled_ = true;
  places_.extend(model::Vec3(record.p_BO[0], record.p_BO[1], record.p_BO[2]));
}

bool ServoEstimator::TargetMoved() const { return !places_.isEmpty() && places_.diagonal().norm() > kMovedM; }

}  // namespace fovea::beliefs
