// SPDX-License-Identifier: Apache-2.0
// The servo's own estimate of the latency: for a target that moves, of which the views of a still target tell
// nothing.
//
// The filters of the target estimate the stamps' common error in each tick (core/estimate/stamp_error.hpp)
// with a model of the target's motion. The last estimate counts.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/stamp_error.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::beliefs {

class ServoEstimator {
 public:
  explicit ServoEstimator(const config::ServoConfig& config)
      : offset_(config.predict.stamp_offset),
        most_(estimate::kMostStampSigmas * config.predict.stamp_sigma) {}

  void Add(const hal::TickRecord& record);

  // The servo has known a target.
  [[nodiscard]] bool has_seen() const { return has_seen_; }
  // How much older than their stamps the pictures are [s], and its standard deviation.
  [[nodiscard]] const estimate::StampError& late() const { return late_; }
  // The estimate is at the end of what the servo believes: the true value is there or beyond.
  [[nodiscard]] bool is_bound() const { return is_bound_; }

 private:
  double offset_;  // servo.stamp_offset, in force or soon [s]
  double most_;    // largest difference from it that the servo believes [s]
  bool has_seen_ = false;
  bool is_bound_ = false;
  estimate::StampError late_;
};

}  // namespace fovea::beliefs
