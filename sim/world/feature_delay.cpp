// SPDX-License-Identifier: Apache-2.0
#include "sim/world/feature_delay.hpp"

namespace fovea::sim {

void FeatureDelay::Put(const hal::FeatureMeasurement& measurement) noexcept {
  {
    const std::lock_guard lock(mutex_);
    // Frames come in order: an earlier one that still has no measurement was lost.
    std::erase_if(expected_, [&](const Expected& expected) {
      return expected.sequence < measurement.sequence && !expected.measurement;
    });
    for (Expected& expected : expected_) {
      if (expected.sequence == measurement.sequence) {
        expected.measurement = measurement;
      }
    }
  }
  changed_.notify_all();
}

void FeatureDelay::Expect(std::uint64_t sequence, std::int64_t due_ns) {
  const std::lock_guard lock(mutex_);
  expected_.push_back({sequence, due_ns, std::nullopt});
}

bool FeatureDelay::HandOver(std::int64_t now_ns, bool wait, hal::FeatureSink& servo) {
  std::unique_lock lock(mutex_);
  while (!expected_.empty() && expected_.front().due_ns <= now_ns) {
    if (wait) {
      changed_.wait(
          lock, [this] { return closed_ || expected_.empty() || expected_.front().measurement.has_value(); });
      if (expected_.empty()) {
        return !closed_;
      }
    }
    if (!expected_.front().measurement) {
      return !closed_;
    }
    servo.Put(*expected_.front().measurement);
    expected_.pop_front();
  }
  return true;
}

void FeatureDelay::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

}  // namespace fovea::sim
