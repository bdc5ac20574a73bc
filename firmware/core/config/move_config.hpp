// SPDX-License-Identifier: Apache-2.0
// [servo] commanded motions of the end effector.
#pragma once

#include "firmware/core/config/fields.hpp"

namespace fovea::config {

struct MoveConfig {
  double speed = 0.5;
  double acceleration = 2.0;
  double jerk = 20.0;
  double turn_speed = 1.0;
  double turn_acceleration = 4.0;
  double turn_jerk = 40.0;
  double pose_gain = 20.0;
  double pose_error_max = 0.02;
};

template <class Visitor, Struct<MoveConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  constexpr const char* kOfHand = "of the end effector in commanded motions";
  v.Number({"servo.move_speed", "m/s", kOfHand}, c.speed, 0.001, 10.0);
  v.Number({"servo.move_acceleration", "m/s^2", kOfHand}, c.acceleration, 0.001, 1000.0);
  v.Number({"servo.move_jerk", "m/s^3", kOfHand}, c.jerk, 0.001, 1e6);
  v.Number({"servo.turn_speed", "rad/s", kOfHand}, c.turn_speed, 0.001, 10.0);
  v.Number({"servo.turn_acceleration", "rad/s^2", kOfHand}, c.turn_acceleration, 0.001, 1000.0);
  v.Number({"servo.turn_jerk", "rad/s^3", kOfHand}, c.turn_jerk, 0.001, 1e6);
  v.Number(
      {"servo.pose_gain", "1/s", "gain that corrects the end effector's deviation from its commanded path"},
      c.pose_gain, 0.0, 200.0);
  v.Number({"servo.pose_error_max", "m",
            "the motion is refused if the end effector deviates further from its commanded path"},
           c.pose_error_max, 1e-6, 10.0);
}

}  // namespace fovea::config
