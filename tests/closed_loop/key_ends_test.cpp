// SPDX-License-Identifier: Apache-2.0
// Keys at the ends of their ranges: whether the task is done or refused, the true arm keeps its limits.
#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

using Keys = std::vector<std::string>;

class KeysAtTheirEnds : public testing::TestWithParam<Keys> {};

TEST_P(KeysAtTheirEnds, KeepTheLimits) {
  Keys keys = GetParam();
  keys.insert(keys.end(), {"run.duration_s=5", "motion.lead_s=2"});
  const sim::Summary s = RunShipped("flange-circle", keys);
  for (const std::string& key : GetParam()) {
    std::cout << key << ' ';
  }
  std::cout << ": true acceleration at most " << s.limits.at("true_joint_acceleration") << " of its limit, "
            << s.verdict << '\n';
  EXPECT_EQ(s.limit_violations, 0U);
  EXPECT_EQ(s.contact_ticks, 0U);
  EXPECT_TRUE(s.faults.empty()) << run::InWords(s.faults.front());
}

INSTANTIATE_TEST_SUITE_P(
    Gains, KeysAtTheirEnds,
    testing::Values(
        Keys{"servo.omega_n=80", "servo.zeta=2.5"}, Keys{"servo.omega_n=20", "servo.zeta=10"},
        Keys{"servo.omega_n=80", "servo.zeta=0.1"},
        Keys{"servo.motion_law=operational_space", "servo.omega_n=80", "servo.zeta=2.5"},
        Keys{"servo.motion_law=pd", "servo.omega_n=80", "servo.zeta=0.46"},
        Keys{"servo.motion_law=pd", "servo.omega_n=3.75", "servo.zeta=10"},
        Keys{"servo.motion_law=joint_impedance", "servo.omega_n=80", "servo.zeta=0.46"},
        Keys{"servo.motion_law=joint_impedance", "servo.omega_n=3.75", "servo.zeta=10"},
        Keys{"servo.integral=25", "servo.integral_torque_fraction=1"},
        Keys{"servo.integral=8", "servo.omega_n=80", "servo.zeta=0.1", "servo.integral_torque_fraction=1"},
        Keys{"servo.integral=100", "servo.omega_n=80", "servo.zeta=2", "servo.integral_torque_fraction=1"},
        Keys{"servo.friction_compensation=1", "arm.friction_compensation=0"}));

constexpr const char* kVelocity = "safety.joint_velocity_fraction=0.95";
constexpr const char* kAcceleration = "safety.joint_acceleration_fraction=0.8";
constexpr const char* kJerk = "safety.joint_jerk_fraction=0.1";
constexpr const char* kBraking = "safety.braking_fraction=0.8";
INSTANTIATE_TEST_SUITE_P(Shares, KeysAtTheirEnds,
                         testing::Values(Keys{kVelocity, kAcceleration, kJerk, kBraking, "motion.rate_hz=1"},
                                         Keys{kVelocity, kAcceleration, kJerk, kBraking, "motion.rate_hz=3"},
                                         Keys{kVelocity, kAcceleration, "motion.rate_hz=3"},
                                         Keys{kJerk, "motion.rate_hz=3"}, Keys{"safety.rotation_speed=0.2"},
                                         Keys{"safety.rotation_speed=0.38", "servo.pose_error_max=10",
                                              "motion.rate_hz=2"},
                                         Keys{"safety.boot_ticks=1", "safety.following_error=10"},
                                         Keys{"safety.cartesian_speed=0.01"},
                                         Keys{"safety.torque_fraction=0.3", "motion.rate_hz=3"},
                                         Keys{"safety.torque_rate_fraction=0.5", "motion.rate_hz=3"}));

}  // namespace
}  // namespace fovea::test
