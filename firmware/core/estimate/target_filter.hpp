// SPDX-License-Identifier: Apache-2.0
// Kalman filter of a target's position, velocity and acceleration in the base frame: constant acceleration,
// disturbed by white jerk. Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and
// Navigation (2001), section 6.2.3.
//
// The acceleration is needed: a velocity that is 60 ms old is wrong by 60 ms of acceleration, and the law
// divides that by lambda.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/measurement_doubt.hpp"
#include "firmware/core/model/types.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::estimate {

// Estimate at `stamp_ns`, the stamp of the last accepted measurement.
struct TargetFilter {
  static constexpr int kOrder = 3;  // position, velocity, acceleration
  using Block = std::array<model::Mat3, kOrder>;

  TargetFilter() noexcept;

  int accepted = 0;  // measurements since the start; 0: nothing is known
  int rejected_in_row = 0;
  std::int64_t stamp_ns = 0;
  std::array<model::Vec3, kOrder> x;  // p_BO [m] and its derivatives
  std::array<Block, kOrder> P;        // covariance of x, block by block
  // The measurements' common error in time: they are this much older than their stamps [s].
  double late = 0.0;
  double P_late = 0.0;                       // its variance [s^2]
  std::array<model::Vec3, kOrder> P_x_late;  // covariance of x and it
};

// A measured centre of the target.
struct MeasuredCentre {
  std::int64_t stamp_ns = 0;                    // of its picture
  model::Vec3 p_BO = model::Vec3::Zero();       // [m] in B
  model::Mat3 cov_B = model::Mat3::Zero();      // of its noise [m^2]
  double late = 0.0;                            // p_BO uses the camera's pose this long before the stamp [s]
  double late_sigma = 0.0;                      // standard deviation of `late` [s]; for a filter that starts
  model::Vec3 v_BO_held = model::Vec3::Zero();  // then, of a point there that the camera holds [m/s]
  // Uncertainty from calibration, for the gate alone, of a target at `p_CO_C` [m]; null: none.
  MeasurementDoubt* doubt = nullptr;
  model::Vec3 p_CO_C = model::Vec3::Zero();
  // Rolling shutter: p_BO is off its place at the stamp by this times the target's velocity [s].
  model::Mat3 shift_by_v_B = model::Mat3::Zero();
};

// Adds a measurement. Rejects an outlier; after too many in a row the filter restarts at the newest. Velocity
// and acceleration stay within the configured bounds. Real-time: yes.
[[nodiscard]] hal::Intake Update(const config::PredictConfig& config, const MeasuredCentre& measured,
                                 TargetFilter& filter) noexcept;

// The target's position [m] and velocity [m/s] at `now_ns`, within the same bounds. Real-time: yes.
struct TargetMotion {
  model::Vec3 p_BO;
  model::Vec3 v_BO;
};
[[nodiscard]] TargetMotion MotionAt(const config::PredictConfig& config, const TargetFilter& filter,
                                    std::int64_t now_ns) noexcept;

}  // namespace fovea::estimate
