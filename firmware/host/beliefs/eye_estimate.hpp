// SPDX-License-Identifier: Apache-2.0
// Estimates latency, mount, focal length, target size and encoder zeros from the views of a still target in a
// run (eye_model.hpp).
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/beliefs/eye_model.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::beliefs {

struct EyeEstimate {
  int views = 0;        // used; 0: too few for an estimate
  double misfit = 0.0;  // of the views, in their stated standard deviations
  // The views are those of a still target, seen by a camera of this model. If not, nothing is known.
  [[nodiscard]] bool Fits() const { return views > 0 && misfit <= Findings::kMostMisfit; }
  EyeState state;
  std::vector<Belief> beliefs;
};

class EyeEstimator {
 public:
  explicit EyeEstimator(const config::ServoConfig& config) : config_(config) {}

  // Takes a tick's reading, and its measurement, if any. A view counts only if the camera has moved since
  // the one before, because the errors of equal pictures are equal.
  void Add(const hal::TickRecord& record);

  [[nodiscard]] EyeEstimate Estimate() const;

 private:
  struct View {
    hal::FeatureMeasurement measurement;
    model::Pose X_BC;  // as believed
  };
  [[nodiscard]] std::optional<model::Pose> FirstGuess() const;
  [[nodiscard]] std::vector<Equations> CompareAll(const std::vector<int>& turns, const EyeState& state) const;
  [[nodiscard]] int TurnOf(const View& view, const EyeState& state) const;

  const config::ServoConfig config_;
  JointTrack track_;
  std::deque<View> views_;
  std::optional<model::Pose> X_BO_;  // the servo's last belief
};

}  // namespace fovea::beliefs
