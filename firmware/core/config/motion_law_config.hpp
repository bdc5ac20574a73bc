// SPDX-License-Identifier: Apache-2.0
// [servo] the inner loop: how the joints follow their reference. The laws are in motion_laws/motion_law.hpp.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/fields.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::config {

enum class MotionLawKind : std::uint8_t { kComputedTorque, kPd, kJointImpedance, kOperationalSpace, kFloat };
inline constexpr std::array<const char*, 5> kMotionLawNames{"computed_torque", "pd", "joint_impedance",
                                                            "operational_space", "float"};
inline constexpr int kNumMotionLaws = static_cast<int>(kMotionLawNames.size());

struct MotionLawConfig {
  MotionLawKind kind = MotionLawKind::kComputedTorque;
  double omega_n = 25.0;
  double zeta = 1.0;
  double integral = 0.0;
  double integral_torque_fraction = 0.2;
  hal::JointArray k_p{};
  hal::JointArray k_v{};
  bool damp_by_inertia = true;  // joint_impedance: damping from zeta and the inertia, not k_v
  double friction_compensation = 0.0;
  double friction_width = 0.05;
  double friction_slow = 0.02;
  double operational_damping = 1e-3;
  double change_s = 0.2;
};

template <class Visitor, Struct<MotionLawConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Choice(
      {"servo.motion_law", "", "how the joints follow their reference; float: not at all, to be led by hand"},
      c.kind, kMotionLawNames);
  v.Number({"servo.omega_n", "rad/s", "natural frequency of the joints' error"}, c.omega_n, 0.1, 80.0);
  v.Number({"servo.zeta", "", "damping of the joints' error"}, c.zeta, 0.1, 10.0);
  v.Number(
      {"servo.integral", "1/s",
       "computed_torque: rate at which a constant error is removed, at most zeta omega_n; 0: no integral"},
      c.integral, 0.0, 100.0);
  v.Number({"servo.integral_torque_fraction", "", "bound of the integral, as a share of a joint's torque"},
           c.integral_torque_fraction, 0.0, 1.0);
  v.PerJoint({"servo.k_p", "Nm/rad",
              "pd and joint_impedance: stiffness, one per joint; from servo.omega_n when not given"},
             c.k_p, 0.0, 1e6);
  v.PerJoint({"servo.k_v", "Nm s/rad",
              "pd and joint_impedance: damping, one per joint; from servo.zeta when not given"},
             c.k_v, 0.0, 1e6);
  v.Derived({"servo.k_v"}, c.damp_by_inertia);
  v.Number({"servo.friction_compensation", "",
            "share of the joints' friction that the servo compensates, if the robot does not"},
           c.friction_compensation, 0.0, 1.0);
  v.Number({"servo.friction_width", "rad/s",
            "below this speed the friction's sign changes smoothly; too small: a joint jerks as it reverses"},
           c.friction_width, 1e-9, 10.0);
  v.Number({"servo.friction_slow", "rad/s",
            "below this measured speed the friction takes the sign of the reference speed"},
           c.friction_slow, 1e-9, 10.0);
  v.Number({"servo.operational_damping", "",
            "operational_space: damping near a singularity, relative to the inertia's size"},
           c.operational_damping, 1e-9, 1.0);
  v.Number({"servo.change_s", "s", "duration of the change from one motion law to another"}, c.change_s,
           0.001, 10.0);
}

}  // namespace fovea::config
