// SPDX-License-Identifier: Apache-2.0
// Positions of the target's features in the picture, frame by frame, and their goals: the centre of a round
// target, each corner of a plate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/host/report/run_data.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"

namespace fovea::report {

// Pixels are those of a lens without distortion, as the servo sees them.
class FeaturePath {
 public:
  explicit FeaturePath(PixelPath& path) : path_(path) {}

  // Before the first measurement: the goal.
  void Begin(const log::Setup& setup);
  // In order of time. A frame without target is a gap.
  void Add(const log::Feature& feature, double t_s);

 private:
  void Thin();

  PixelPath& path_;
  double f_px_ = 0.0;
  double c_u_px_ = 0.0;
  double c_v_px_ = 0.0;
  std::vector<float> before_;  // of the last frame with the target
  std::int64_t frames_ = 0;
  std::int64_t stride_ = 1;  // one of so many frames is kept
};

}  // namespace fovea::report
