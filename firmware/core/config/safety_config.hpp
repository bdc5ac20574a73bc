// SPDX-License-Identifier: Apache-2.0
// [safety] limits of the torque, and the conditions of a fault.
#pragma once

#include "firmware/core/config/fields.hpp"

namespace fovea::config {

struct SafetyConfig {
  double torque_fraction = 1.0;
  double torque_rate_fraction = 1.0;
  int arm_lost_ticks = 20;
  int non_finite_ticks = 5;
  int missed_ticks = 20;
  int boot_ticks = 20;
  double boot_velocity = 0.05;
  double setpoint_jump = 1e-3;
  double following_error = 0.15;
  double contact_torque_fraction = 0.2;
  double contact_sudden_fraction = 0.1;
  double contact_gain = 60.0;
  double fault_damping = 10.0;
  double brake_velocity = 0.02;
  double brake_after_s = 0.3;
  double encoder_quantum = 1e-4;
  double stiction_fraction = 0.5;
  double motion_error = 0.05;
  int frozen_ticks = 20;
  double carried_torque_fraction = 0.1;
};

// With less torque, the arm cannot follow the reference that the guard allows: it swings about it and exceeds
// the joints' limits. To use less torque, lower the guard's shares of acceleration and jerk.
inline constexpr double kLeastTorqueShare = 0.3;
inline constexpr double kLeastTorqueRateShare = 0.5;

template <class Visitor, Struct<SafetyConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Number({"safety.torque_fraction", "", "share of the arm's torque range in use"}, c.torque_fraction,
           kLeastTorqueShare, 1.0);
  v.Number({"safety.torque_rate_fraction", "", "share of the arm's torque rate in use"},
           c.torque_rate_fraction, kLeastTorqueRateShare, 1.0);
  v.Integer({"safety.arm_lost_ticks", "ms", "Fault after this time without a new state of the arm"},
            c.arm_lost_ticks, 1, 10000);
  v.Integer({"safety.non_finite_ticks", "ms",
             "a joint value that is not finite is bridged for this time; then Fault"},
            c.non_finite_ticks, 0, 10000);
  v.Integer({"safety.missed_ticks", "ms", "Fault when deadlines are missed in a row for this time"},
            c.missed_ticks, 1, 10000);
  v.Integer({"safety.boot_ticks", "ms", "Boot ends after the arm's states have been sound for this time"},
            c.boot_ticks, 1, 10000);
  v.Number({"safety.boot_velocity", "rad/s", "Boot ends only if every joint is slower than this"},
           c.boot_velocity, 1e-6, 1e3);
  v.Number({"safety.setpoint_jump", "rad",
            "largest distance of a commanded setpoint from the joint's expected next position"},
           c.setpoint_jump, 0.0, 1e3);
  v.Number({"safety.following_error", "rad", "Fault if a joint is further from its reference"},
           c.following_error, 1e-4, 10.0);
  v.Number({"safety.contact_torque_fraction", "",
            "Fault if the external torque exceeds this share of a joint's torque"},
           c.contact_torque_fraction, 0.001, 1e6);
  v.Number({"safety.contact_gain", "1/s",
            "gain of the observer that estimates the external torque from the arm's momentum"},
           c.contact_gain, 0.1, 300.0);
  v.Number({"safety.fault_damping", "1/s", "damping of the stop after a fault"}, c.fault_damping, 0.1, 100.0);
  v.Number({"safety.brake_velocity", "rad/s", "after a fault the brakes close when every joint is slower"},
           c.brake_velocity, 1e-6, 10.0);
  v.Number({"safety.brake_after_s", "s",
            "after a fault the brakes close after this time, even if a joint is faster"},
           c.brake_after_s, 0.0, 60.0);
  v.Number({"safety.encoder_quantum", "rad",
            "step of a joint's reading; Fault if a reading stays the same although torque should have moved "
            "the joint by three steps"},
           c.encoder_quantum, 0.0, 0.1);
  v.Number({"safety.stiction_fraction", "",
            "share of a joint's Coulomb friction that may hold it still although torque changes"},
           c.stiction_fraction, 0.0, 10.0);
  v.Number({"safety.motion_error", "rad",
            "Hold if a joint is further from a commanded motion, averaged over a quarter of a second"},
           c.motion_error, 1e-5, 10.0);
  v.Integer({"safety.frozen_ticks", "ms",
             "Fault if a joint that flickers at rest repeats its reading to the last bit for this time; 0: "
             "no check"},
            c.frozen_ticks, 0, 10000);
  v.Number(
      {"safety.carried_torque_fraction", "",
       "a standing arm compensates three quarters of an unknown load, with at most this share of a joint's "
       "torque; not with the spring laws (pd, joint_impedance) or with `servo.integral`; 0: no compensation"},
      c.carried_torque_fraction, 0.0, 1.0);
  v.Number({"safety.contact_sudden_fraction", "",
            "Fault if the external torque changes by more than this share of a joint's torque within about "
            "0.2 s"},
           c.contact_sudden_fraction, 0.001, 1e6);
}

}  // namespace fovea::config
