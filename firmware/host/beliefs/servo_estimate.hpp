// SPDX-License-Identifier: Apache-2.0
// The servo's own estimate of the latency: for a target that moves, of which the views of a still target tell
// nothing.
//
// The filters of the target estimate the stamps' common error in each tick (core/estimate/stamp_error.hpp)
// with a model of the target's motion. Where that model is wrong, as with a mount that is turned by some
// degrees, the estimate wanders by more than its standard deviation says. So it counts only after it has been
// watched for a second, and half the range in which it was then is the least that it may be wrong by. What
// was seen by an eye that the servo came to doubt does not count.
#pragma once

#include <Eigen/Geometry>
#include <deque>

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

  // The servo has known a target for long enough, and does not doubt its eye.
  [[nodiscard]] bool HasSettled() const { return has_settled_; }
  // How much older than their stamps the pictures are [s], and its standard deviation. The last estimate that
  // had settled.
  [[nodiscard]] const estimate::StampError& late() const { return late_; }
  // The estimate is at the end of what the servo believes: the true value is there or beyond.
  [[nodiscard]] bool is_bound() const { return is_bound_; }
  // The places at which the servo believed the target are further apart than a wrong eye alone explains.
  [[nodiscard]] bool TargetMoved() const;

 private:
  struct Sample {
    std::int64_t stamp_ns;
    double mean_s;
  };
  void Forget();

  double offset_;  // servo.stamp_offset, in force or soon [s]
  double most_;    // largest difference from it that the servo believes [s]
  bool has_settled_ = false;
  bool is_bound_ = false;
  estimate::StampError late_;
  std::deque<Sample> recent_;  // since the target is known, not older than what is watched
  std::int64_t known_since_ns_ = 0;
  Eigen::AlignedBox3d places_;  // of the target in B [m]
};

}  // namespace fovea::beliefs
