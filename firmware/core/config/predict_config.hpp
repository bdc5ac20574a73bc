// SPDX-License-Identifier: Apache-2.0
// [servo] the target's current place: prediction, filters, and the checks of each measurement.
#pragma once

#include "firmware/core/config/fields.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::config {

inline constexpr int kStampOffsetKey = 13;  // number of servo.stamp_offset, for servo.learn

struct Box {
  model::Vec3 low = model::Vec3::Zero();   // [m]
  model::Vec3 high = model::Vec3::Zero();  // [m]
};

struct PredictConfig {
  bool enabled = true;
  double target_jerk = 1.0;
  double target_turn = 0.1;
  double gate_sigma = 6.0;
  int gate_rejects_max = 3;
  int accepted_min = 3;
  double stale_s = 0.15;
  double coast_s = 0.6;
  double target_speed_max = 1.0;
  double target_acceleration_max = 5.0;
  double target_turn_max = 3.0;
  Box target_region{model::Vec3::Constant(-3.0), model::Vec3::Constant(3.0)};
  double stuck_shift = 0.0036;  // in the normalised image
  double stamp_sigma = 0.01;
  double mount_shift_sigma = 0.005;
  double mount_turn_sigma = 0.02;
  double scale_sigma = 0.02;
  double way_in_vain = 0.5;
  // Rolling shutter: row y of the normalised image is exposed row_time (y - row_y) after the stamp.
  double row_time = 0.0;      // [s]; 0: all rows at once
  double row_y = 0.0;         // of the stamp's row
  double stamp_offset = 0.0;  // [s]
};

// Coast comes before Hold. Init checks it, and so does each change in motion.
inline bool IsStaleBeforeLost(const PredictConfig& c) noexcept { return c.stale_s <= c.coast_s; }

template <class Visitor, Struct<PredictConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Flag({"servo.predict", "",
          "predict the target for every tick; false: hold the newest measurement unchanged"},
         c.enabled);
  v.Number(
      {"servo.target_jerk", "m/s^3",
       "how fast the target's acceleration may change; larger follows faster, filters less", kInMotion<8>},
      c.target_jerk, 0.0, 1000.0);
  v.Number({"servo.target_turn", "rad/s^2", "square and triangle: how fast their angular velocity may change",
            kInMotion<9>},
           c.target_turn, 0.0, 1000.0);
  v.Number({"servo.gate_sigma", "sigma", "a measurement that deviates more than this is an outlier",
            kInMotion<10>},
           c.gate_sigma, 1.0, 1000.0);
  v.Integer({"servo.gate_rejects_max", "",
             "after this many outliers in a row the filter restarts at the newest one"},
            c.gate_rejects_max, 1, 1000);
  v.Integer({"servo.accepted_min", "", "number of measurements before the target counts as known"},
            c.accepted_min, 1, 1000);
  v.Number({"servo.stale_s", "s", "Coast after this time without a measurement", kInMotion<11>}, c.stale_s,
           0.001, 10.0);
  v.Number({"servo.coast_s", "s", "Hold after this time without a measurement", kInMotion<12>}, c.coast_s,
           0.001, 60.0);
  v.Number({"servo.target_speed_max", "m/s", "upper bound of the target's estimated speed"},
           c.target_speed_max, 0.0, 10.0);
  v.Number({"servo.target_acceleration_max", "m/s^2", "upper bound of the target's estimated acceleration"},
           c.target_acceleration_max, 0.0, 100.0);
  v.Number({"servo.target_turn_max", "rad/s", "upper bound of the target's estimated angular velocity"},
           c.target_turn_max, 0.0, 100.0);
  v.Derived({"servo.target_region", "m",
             "box that the target stays in: measurements outside are rejected, predictions are kept inside; "
             "low x, y, z, high x, y, z, in axes of the base"},
            c.target_region.low, -100.0, 100.0);
  v.Derived({"servo.target_region"}, c.target_region.high, -100.0, 100.0);
  v.Derived({"servo.stuck_shift_px", "px",
             "a picture that stays the same within its noise is rejected once the hand's motion must have "
             "shifted the scene by more than this"},
            c.stuck_shift, 1e-6, 1e6);
  v.Number(
      {"servo.stamp_sigma", "s",
       "standard deviation of camera.latency_ms: the servo finds an error of up to three of them while the "
       "camera moves; 0: the stamps are right"},
      c.stamp_sigma, 0.0, 0.1);
  v.Number({"servo.mount_shift_sigma", "m", "standard deviation of camera.mount_xyz"}, c.mount_shift_sigma,
           0.0, 1.0);
  v.Number({"servo.mount_turn_sigma", "rad", "standard deviation of the mount's orientation"},
           c.mount_turn_sigma, 0.0, 1.0);
  v.Number({"servo.scale_sigma", "", "relative standard deviation of focal length and target size"},
           c.scale_sigma, 0.0, 1.0);
  v.Number({"servo.way_in_vain", "m",
            "Hold if the camera moves this far and the error does not decrease; Track must then be requested "
            "again"},
           c.way_in_vain, 0.001, 1000.0);
  v.Derived({"camera.row_time_us"}, c.row_time, 0.0, 1e3);
  v.Derived({"camera.row_time_us"}, c.row_y, -1e6, 1e6);
  v.Number(
      {"servo.stamp_offset", "s",
       "the pictures are this much older than camera.latency_ms says: what the servo expects before it has "
       "seen a target, and the middle of the errors that it believes (servo.stamp_sigma)",
       kInMotion<kStampOffsetKey>},
      c.stamp_offset, -0.05, 0.05);
}

}  // namespace fovea::config
