// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/roc.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::contact {
namespace {

constexpr double kTickS = 1e-3;
constexpr double kQuietS = 0.5;  // an alarm ends after this time below the threshold

}  // namespace

std::size_t NearestThreshold(double share) {
  const double i = std::round(share / ThresholdAt(0)) - 1.0;
  return static_cast<std::size_t>(std::clamp(i, 0.0, static_cast<double>(kNumThresholds - 1)));
}

QuietRun JudgeQuiet(const Recording& recording) {
  QuietRun run;
  for (const WatchedTick& tick : recording.ticks) {
    run.moving_s += tick.moves ? kTickS : 0.0;
  }
  for (std::size_t d = 0; d < kDetectors.size(); ++d) {
    for (std::size_t i = 0; i < kNumThresholds; ++i) {
      double over_until_s = -1.0;
      for (const WatchedTick& tick : recording.ticks) {
        if (tick.share[d] > ThresholdAt(i)) {
          run.alarms[d][i] += tick.t_s > over_until_s ? 1 : 0;
          over_until_s = tick.t_s + kQuietS;
        }
      }
    }
  }
  return run;
}

PushedRun JudgePushed(const Recording& recording, double from_s, double to_s) {
  PushedRun run;
  if (!recording.fault.empty() && recording.fault_s >= from_s) {
    run.other_guard_ms = 1e3 * (recording.fault_s - from_s);
  }
  for (std::size_t d = 0; d < kDetectors.size(); ++d) {
    for (std::size_t i = 0; i < kNumThresholds; ++i) {
      bool was_over = false;
      for (const WatchedTick& tick : recording.ticks) {
        const bool is_over = tick.share[d] > ThresholdAt(i);
        if (tick.t_s >= from_s && tick.t_s <= to_s && is_over && !was_over) {
          run.after_ms[d][i] = 1e3 * (tick.t_s - from_s);
          break;
        }
        was_over = is_over;
      }
    }
  }
  return run;
}

Detection Detect(const std::vector<PushedRun>& runs, Detector detector, std::size_t threshold) {
  Detection detection;
  std::vector<double> times;
  for (const PushedRun& run : runs) {
    ++detection.pushes;
    if (const auto& after_ms = run.after_ms[static_cast<std::size_t>(detector)][threshold]) {
      times.push_back(*after_ms);
    } else if (run.other_guard_ms) {
      ++detection.by_others;
    }
  }
  detection.detected = static_cast<int>(times.size());
  if (!times.empty()) {
    std::sort(times.begin(), times.end());
    detection.median_ms = 0.5 * (times[(times.size() - 1) / 2] + times[times.size() / 2]);
    detection.most_ms = times.back();
  }
  return detection;
}

double FalseAlarms::PerHourAtMost() const {
  // Chi-square quantile of 2 (alarms + 1) degrees of freedom by Wilson and Hilferty, half of it.
  constexpr double kZ95 = 1.6448536269514722;
  const double n = 2.0 * (alarms + 1);
  const double x = 1.0 - 2.0 / (9.0 * n) + kZ95 * std::sqrt(2.0 / (9.0 * n));
  return moving_s > 0.0 ? 3600.0 * 0.5 * n * x * x * x / moving_s : 0.0;
}

FalseAlarms CountAlarms(const std::vector<QuietRun>& runs, Detector detector, std::size_t threshold) {
  FalseAlarms sum;
  for (const QuietRun& run : runs) {
    sum.alarms += run.alarms[static_cast<std::size_t>(detector)][threshold];
    sum.moving_s += run.moving_s;
  }
  return sum;
}

}  // namespace fovea::contact
