// SPDX-License-Identifier: Apache-2.0
#include "sim/world/exposure_history.hpp"

#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {

void ExposureHistory::Add(Moment now) {
  // An exposure ends between two steps and is taken at the second one.
  const std::int64_t oldest_ns = now.time_ns - 2 * reach_ns_ - hal::kTickPeriodNs;
  past_.push_back(std::move(now));
  while (past_.size() > 1 && past_[1].time_ns <= oldest_ns) {
    past_.pop_front();
  }
}

void ExposureHistory::Begin(std::uint64_t sequence) {
  Exposure& exposure = running_.emplace_back();
  static_cast<Moment&>(exposure) = past_.back();
  exposure.sequence = sequence;
  exposure.stamp_ns = exposure.time_ns;
}

std::optional<Exposure> ExposureHistory::TakeEnded() {
  if (running_.empty() || past_.back().time_ns < running_.front().time_ns + reach_ns_) {
    return std::nullopt;
  }
  Exposure exposure = std::move(running_.front());
  running_.pop_front();
  if (reach_ns_ > 0) {
    exposure.around = std::make_shared<const std::vector<Moment>>(past_.begin(), past_.end());
  }
  return exposure;
}

}  // namespace fovea::sim
