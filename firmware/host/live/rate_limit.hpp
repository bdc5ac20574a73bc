// SPDX-License-Identifier: Apache-2.0
// A rate with a burst: so many events at once, and so many a second on average.
#pragma once

#include <algorithm>
#include <chrono>

namespace fovea::live {

using Clock = std::chrono::steady_clock;

class RateLimit {
 public:
  RateLimit(double per_s, double burst) : per_s_(per_s), burst_(burst), left_(burst) {}

  // False when the event is too many.
  [[nodiscard]] bool Take(Clock::time_point now) {
    if (last_ < now) {
      const bool is_first = last_ == Clock::time_point{};
      left_ = is_first
                  ? burst_
                  : std::min(burst_, left_ + per_s_ * std::chrono::duration<double>(now - last_).count());
      last_ = now;
    }
    if (left_ < 1.0) {
      return false;
    }
    left_ -= 1.0;
    return true;
  }

 private:
  double per_s_;
  double burst_;
  double left_;
  Clock::time_point last_{};
};

}  // namespace fovea::live
