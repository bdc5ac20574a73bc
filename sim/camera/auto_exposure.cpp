// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/auto_exposure.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::sim {

void AutoExposure::Measure(std::uint64_t index, std::int64_t stamp_ns, std::optional<Brightness> brightness) {
  waiting_[index] = {stamp_ns, brightness};
  for (auto at = waiting_.find(next_); at != waiting_.end(); at = waiting_.find(++next_)) {
    const Measured& measured = at->second;
    if (measured.brightness && measured.brightness->mean > 0.0) {
      const double wanted = std::log(measured.brightness->gain * config_.level / measured.brightness->mean);
      const double since_s = 1e-9 * static_cast<double>(measured.stamp_ns - last_ns_);
      log_gain_ += (1.0 - std::exp(-since_s / config_.lag_s)) * (wanted - log_gain_);
      log_gain_ = std::clamp(log_gain_, -std::log(config_.gain_max), std::log(config_.gain_max));
      last_ns_ = measured.stamp_ns;
    }
    gains_[next_ + kBehind] = std::exp(log_gain_);
    gains_.erase(gains_.begin(), gains_.lower_bound(next_ - std::min(next_, kKept)));
    waiting_.erase(at);
  }
}

std::optional<double> AutoExposure::TakeGain(std::uint64_t index) {
  if (!config_.IsOn() || index < kBehind) {
    return 1.0;
  }
  const auto at = gains_.find(index);
  if (at == gains_.end()) {
    return std::nullopt;
  }
  const double gain = at->second;
  gains_.erase(at);
  return gain;
}

}  // namespace fovea::sim
