// [servo] where the target is now: prediction, filters, and how much of a measurement is believed.
#pragma once

#include "firmware/core/config/fields.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::config {

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
  double stamp_sigma = 0.004;
  double mount_shift_sigma = 0.005;
  double mount_turn_sigma = 0.02;
  double scale_sigma = 0.02;
  double way_in_vain = 0.5;
};

template <class Visitor, Struct<PredictConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Flag({"servo.predict", "",
          "predict the target for every tick; false: hold the newest measurement as it came"},
         c.enabled);
  v.Number({"servo.target_jerk", "m/s^3",
            "how fast the target's acceleration may change; larger follows faster, filters less"},
           c.target_jerk, 0.0, 1000.0);
  v.Number(
      {"servo.target_turn", "rad/s^2", "square and triangle: how fast their angular velocity may change"},
      c.target_turn, 0.0, 1000.0);
  v.Number({"servo.gate_sigma", "sigma", "a measurement further off than this is an outlier"}, c.gate_sigma,
           1.0, 1000.0);
  v.Integer({"servo.gate_rejects_max", "",
             "after so many outliers in a row the target is taken to have moved there"},
            c.gate_rejects_max, 1, 1000);
  v.Integer({"servo.accepted_min", "", "measurements before the target counts as known"}, c.accepted_min, 1,
            1000);
  v.Number({"servo.stale_s", "s", "without a measurement for so long: Coast"}, c.stale_s, 0.001, 10.0);
  v.Number({"servo.coast_s", "s", "without a measurement for so long: Hold"}, c.coast_s, 0.001, 60.0);
  v.Number({"servo.target_speed_max", "m/s", "the target is never taken to be faster, whatever is measured"},
           c.target_speed_max, 0.0, 10.0);
  v.Number({"servo.target_acceleration_max", "m/s^2", "the target is never taken to accelerate harder"},
           c.target_acceleration_max, 0.0, 100.0);
  v.Number({"servo.target_turn_max", "rad/s", "the target is never taken to turn faster"}, c.target_turn_max,
           0.0, 100.0);
  v.Derived({"servo.target_region", "m",
             "a measurement that puts the target outside this box is refused, and the prediction stays "
             "inside: low x, "
             "y, z, high x, y, z, in axes of the base"},
            c.target_region.low, -100.0, 100.0);
  v.Derived({"servo.target_region"}, c.target_region.high, -100.0, 100.0);
  v.Derived({"servo.stuck_shift_px", "px",
             "a picture that stays the same within its noise, although the hand shifted the scene in it by "
             "more than "
             "this, is no measurement"},
            c.stuck_shift, 1e-6, 1e6);
  v.Number({"servo.stamp_sigma", "s", "standard deviation of the measurements' stamps"}, c.stamp_sigma, 0.0,
           1.0);
  v.Number({"servo.mount_shift_sigma", "m", "standard deviation of camera.mount_xyz"}, c.mount_shift_sigma,
           0.0, 1.0);
  v.Number({"servo.mount_turn_sigma", "rad", "standard deviation of the mount's orientation"},
           c.mount_turn_sigma, 0.0, 1.0);
  v.Number({"servo.scale_sigma", "", "standard deviation of focal length and target size, as a share"},
           c.scale_sigma, 0.0, 1.0);
  v.Number({"servo.way_in_vain", "m",
            "the camera has gone so far and its error got no smaller: Hold, until Track is asked for anew"},
           c.way_in_vain, 0.001, 1000.0);
}

}  // namespace fovea::config
