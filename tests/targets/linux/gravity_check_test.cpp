// SPDX-License-Identifier: Apache-2.0
// Gravity from the measured torques compared with the model: how an unknown load appears.
#include "firmware/targets/linux/gravity_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/load.hpp"
#include "tests/support/panda.hpp"

namespace fovea::hw {
namespace {

hal::JointArray GravityOf(const model::ArmModel& arm, const hal::JointArray& q) {
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(arm, model::ToVector(q, arm.num_joints), poses);
  model::ComputeDynamics(arm, poses, model::VecN::Zero(arm.num_joints), dynamics);
  return model::ToArray(dynamics.g);
}

TEST(GravityCheckTest, FindsAnUnknownMassAndNoneForTheModelsOwn) {
  const model::ArmModel arm = test::Panda().model;
  const hal::JointArray& q = arm.q_ready;
  const GravityFinding right = CompareGravity(arm, q, GravityOf(arm, q));
  EXPECT_NEAR(right.worst_nm, 0.0, 1e-12);
  EXPECT_NEAR(right.unknown_mass_kg, 0.0, 1e-12);
  for (const double mass : {-0.2, 0.3, 0.7, 2.0}) {
    model::ArmModel heavy = arm;
    model::Attach({.mass = mass}, heavy);
    const GravityFinding finding = CompareGravity(arm, q, GravityOf(heavy, q));
    EXPECT_NEAR(finding.unknown_mass_kg, mass, 1e-9);
    EXPECT_GT(std::fabs(finding.worst_nm), 4.0 * std::fabs(mass))
        << "the Panda's reach at the ready posture is about half a metre";
    std::printf("%s\n", InWords(finding).c_str());
  }
}

TEST(GravityCheckTest, NonFiniteTorqueNeverPasses) {
  const model::ArmModel arm = test::Panda().model;
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    hal::JointArray tau = GravityOf(arm, arm.q_ready);
    tau[4] = wrong;
    EXPECT_FALSE(std::fabs(CompareGravity(arm, arm.q_ready, tau).worst_nm) <= 100.0);
    EXPECT_EQ(CompareGravity(arm, arm.q_ready, tau).joint, 4);
  }
}

TEST(RestMeanTest, AveragesOnlyConsecutiveStatesAtRest) {
  RestMean mean(10, 0.05);
  hal::ArmState state;
  const auto add = [&](double speed, double tau, int times) {
    bool there = false;
    for (int k = 0; k < times; ++k) {
      state.dq[3] = speed;
      state.tau_meas[1] = tau + (k % 2 == 0 ? 0.5 : -0.5);
      state.q[1] = 0.25;
      there = mean.Add(state);
    }
    return there;
  };
  EXPECT_FALSE(add(0.0, 100.0, 9));
  EXPECT_FALSE(add(-0.06, 100.0, 1)) << "a movement restarts the average";
  EXPECT_FALSE(add(0.04, 3.0, 9));
  EXPECT_FALSE(mean.IsInVain());
  EXPECT_TRUE(add(0.04, 2.0, 1));
  EXPECT_NEAR(mean.tau_meas()[1], 3.0, 1e-12);
  EXPECT_NEAR(mean.q()[1], 0.25, 1e-12);

  RestMean never(10, 0.05);
  mean = never;
  EXPECT_FALSE(add(1.0, 0.0, 199));
  EXPECT_FALSE(mean.IsInVain());
  EXPECT_FALSE(add(std::nan(""), 0.0, 1));
  EXPECT_TRUE(mean.IsInVain());
}

}  // namespace
}  // namespace fovea::hw
