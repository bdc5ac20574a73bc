// [safety] limits on the torque, and when to stop altogether.
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

// With less, the arm cannot follow what the guard allows the reference: it swings about it and passes the
// joints' limits. Who wants less torque lowers the guard's shares of acceleration and jerk.
inline constexpr double kLeastTorqueShare = 0.3;
inline constexpr double kLeastTorqueRateShare = 0.5;

template <class Visitor, Struct<SafetyConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Number({"safety.torque_fraction", "", "share of the arm's torque range in use"}, c.torque_fraction,
           kLeastTorqueShare, 1.0);
  v.Number({"safety.torque_rate_fraction", "", "share of the arm's torque rate in use"},
           c.torque_rate_fraction, kLeastTorqueRateShare, 1.0);
  v.Integer({"safety.arm_lost_ticks", "ms", "without a new state for so long: Fault"}, c.arm_lost_ticks, 1,
            10000);
  v.Integer({"safety.non_finite_ticks", "ms",
             "a joint value that is not finite is bridged for so long, then: Fault"},
            c.non_finite_ticks, 0, 10000);
  v.Integer({"safety.missed_ticks", "ms", "so many deadlines missed in a row: Fault"}, c.missed_ticks, 1,
            10000);
  v.Integer({"safety.boot_ticks", "ms", "the arm must have been sound for so long before it is moved"},
            c.boot_ticks, 1, 10000);
  v.Number({"safety.boot_velocity", "rad/s", "and every joint slower than this"}, c.boot_velocity, 1e-6, 1e3);
  v.Number({"safety.setpoint_jump", "rad",
            "commanded setpoints start this close to where the arm stands, and go on so"},
           c.setpoint_jump, 0.0, 1e3);
  v.Number({"safety.following_error", "rad", "a joint further off its reference: Fault"}, c.following_error,
           1e-4, 10.0);
  v.Number({"safety.contact_torque_fraction", "",
            "pushed from outside with more than this share of a joint's torque: Fault"},
           c.contact_torque_fraction, 0.001, 1e6);
  v.Number({"safety.contact_gain", "1/s", "of the observer that sees a push from the arm's momentum"},
           c.contact_gain, 0.1, 300.0);
  v.Number({"safety.fault_damping", "1/s", "of the stop after a fault"}, c.fault_damping, 0.1, 100.0);
  v.Number({"safety.brake_velocity", "rad/s", "after a fault the brakes close when every joint is slower"},
           c.brake_velocity, 1e-6, 10.0);
  v.Number({"safety.brake_after_s", "s", "or after this time"}, c.brake_after_s, 0.0, 60.0);
  v.Number(
      {"safety.encoder_quantum", "rad",
       "step of a joint's reading; one that stays the same while torque should have moved the joint by three "
       "of them: Fault"},
      c.encoder_quantum, 0.0, 0.1);
  v.Number({"safety.stiction_fraction", "",
            "share of a joint's Coulomb friction that may hold it still although torque changes"},
           c.stiction_fraction, 0.0, 10.0);
  v.Number({"safety.motion_error", "rad",
            "a joint further off a commanded motion, as a mean over a quarter of a second: Hold"},
           c.motion_error, 1e-5, 10.0);
  v.Integer(
      {"safety.frozen_ticks", "ms",
       "a joint that flickers at rest repeats its reading to the last bit for so long: Fault; 0: it may"},
      c.frozen_ticks, 0, 10000);
  v.Number({"safety.carried_torque_fraction", "",
            "an arm that stands carries three quarters of a load that nobody told it of, with at most this "
            "share of a "
            "joint's torque; not by the laws that are springs (pd, joint_impedance), nor beside "
            "`servo.integral`; 0: "
            "nothing"},
           c.carried_torque_fraction, 0.0, 1.0);
}

}  // namespace fovea::config
