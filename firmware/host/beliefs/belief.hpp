// SPDX-License-Identifier: Apache-2.0
// What a run tells of the values that its servo believes.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fovea::beliefs {

struct Belief {
  std::string name;         // for people: "latency", "mount turn about the camera's x axis"
  std::string key;          // of the configuration; several beliefs may share one
  std::string unit;         // of the numbers below
  double difference = 0.0;  // estimate of the true value less the believed one
  double sigma = 0.0;       // its standard deviation; infinite if nothing is known
  double sigma_max = 0.0;   // largest one with which the difference counts as known
  double matters = 0.0;     // smallest difference worth a word
  // The value of the key, if it is one number that the program knows.
  std::optional<double> configured = std::nullopt;

  [[nodiscard]] bool IsKnown() const { return sigma <= sigma_max; }
  // Known, wrong by more than three standard deviations, and by enough to matter.
  [[nodiscard]] bool IsWrong() const {
    const double size = difference < 0.0 ? -difference : difference;
    return IsKnown() && size > 3.0 * sigma && size >= matters;
  }
};

// What the servo was told while it ran (servo.learn).
struct Correction {
  double t_s = 0.0;  // of the servo's clock
  std::string name;  // for people: "latency"
  std::string key;   // that may change in motion
  std::string unit;  // of the key; "" if it has none
  double from = 0.0;
  double to = 0.0;
  std::string text;  // all of it: "latency: servo.stamp_offset = 0.0182 s since 0.751 s, 0 before"
};

// All that a run tells.
struct Findings {
  int views = 0;        // of the target; 0: too few for an estimate
  double misfit = 0.0;  // of the views, in their stated standard deviations
  // A model with which the views disagree by more is wrong in something that it does not estimate, such as a
  // principal point or a jitter of the stamps; its values are then wrong by more than they state.
  static constexpr double kMostMisfit = 3.0;
  [[nodiscard]] bool DoViewsFit() const { return views == 0 || misfit <= kMostMisfit; }
  int windows = 0;  // of torques, 100 ms each; 0: too few
  std::vector<Belief> beliefs;
  // At most three sentences, each about a belief that is wrong for certain and matters, the surest first:
  // "latency is 58 +- 2 ms, configured 40: set camera.latency_ms = 58".
  std::vector<std::string> verdict;
  std::vector<Correction> learnt;  // applied while the run went on, in order of time
};

}  // namespace fovea::beliefs
