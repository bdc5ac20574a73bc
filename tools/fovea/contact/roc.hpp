// SPDX-License-Identifier: Apache-2.0
// Receiver operating characteristic of a detector of pushes: false alarms against detected pushes, over its
// threshold (Fawcett, An introduction to ROC analysis, 2006).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tools/fovea/contact/recording.hpp"

namespace fovea::contact {

// The thresholds, as shares of a joint's largest torque: 0.01, 0.02 to 0.40.
inline constexpr std::size_t kNumThresholds = 40;
constexpr double ThresholdAt(std::size_t i) { return 0.01 * static_cast<double>(i + 1); }
// The threshold nearest to `share`.
std::size_t NearestThreshold(double share);

template <class T>
using PerThreshold = std::array<T, kNumThresholds>;

// False alarms of a run in which nothing pushes. An alarm ends when the share has been below the threshold
// for 0.5 s.
struct QuietRun {
  double moving_s = 0.0;  // time in which the arm moves
  std::array<PerThreshold<int>, kDetectors.size()> alarms{};
};
QuietRun JudgeQuiet(const Recording& recording);

// Of a run that is pushed from `from_s` to `to_s`.
struct PushedRun {
  // From the begin of the push to the first tick above the threshold [ms]; none: not during the push. A share
  // that exceeds the threshold when the push begins is a false alarm, no detection.
  std::array<PerThreshold<std::optional<double>>, kDetectors.size()> after_ms{};
  std::optional<double> other_guard_ms;  // when another guard stopped the arm instead
};
PushedRun JudgePushed(const Recording& recording, double from_s, double to_s);

// All runs with pushes of one force, or with none.
struct Detection {
  int pushes = 0;
  int detected = 0;
  int by_others = 0;       // not detected, as another guard stopped the arm before
  double median_ms = 0.0;  // of the detected ones
  double most_ms = 0.0;

  // Of the pushes after which the arm stops.
  [[nodiscard]] double Share() const {
    return pushes > 0 ? static_cast<double>(detected + by_others) / pushes : 0.0;
  }
};
Detection Detect(const std::vector<PushedRun>& runs, Detector detector, std::size_t threshold);

struct FalseAlarms {
  int alarms = 0;
  double moving_s = 0.0;

  [[nodiscard]] double PerHour() const { return moving_s > 0.0 ? 3600.0 * alarms / moving_s : 0.0; }
  // Upper end of the one-sided 95 % interval of a Poisson process: 3.0 alarms if none was seen.
  [[nodiscard]] double PerHourAtMost() const;
};
FalseAlarms CountAlarms(const std::vector<QuietRun>& runs, Detector detector, std::size_t threshold);

}  // namespace fovea::contact
