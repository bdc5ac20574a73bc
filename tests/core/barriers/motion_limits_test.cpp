// SPDX-License-Identifier: Apache-2.0
// The limits of a configuration as ranges and rows.
#include "firmware/core/barriers/motion_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/core/barriers/workspace_barrier.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::barriers {
namespace {

TEST(MotionLimitsTest, VelocityRangesShrinkAtJointEndsAndWithAcceleration) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(531);
  MotionLimits limits;
  for (int k = 0; k < 1000; ++k) {
    trajectory::Reference reference{random.Position(config.arm), random.Joints(config.arm, 2.0),
                                    model::VecN::Zero(config.arm.num_joints)};
    LimitJoints(config, reference.q, limits);
    EXPECT_EQ(limits.num_rows, 0);
    const MotionLimits wide = limits;
    LimitAcceleration(config, reference, limits);
    for (int i = 0; i < 7; ++i) {
      const double speed =
          config.guard.joint_velocity_fraction * config.arm.joints[static_cast<std::size_t>(i)].dq_max;
      EXPECT_LE(-speed, wide.dq_min[i]);
      EXPECT_LE(wide.dq_min[i], limits.dq_min[i]);
      EXPECT_LE(limits.dq_min[i], limits.dq_max[i]);
      EXPECT_LE(limits.dq_max[i], wide.dq_max[i]);
      EXPECT_LE(wide.dq_max[i], speed);
      EXPECT_TRUE(wide.dq_min[i] <= 0.0 && wide.dq_max[i] >= 0.0) << "standing still is allowed";
    }
  }
  model::VecN q = test::Ready();
  q[1] = config.arm.joints[1].q_max - config.guard.joint_position_margin;
  LimitJoints(config, q, limits);
  EXPECT_EQ(limits.dq_max[1], 0.0);
  EXPECT_LT(limits.dq_min[1], -0.1);
}

TEST(MotionLimitsTest, WorkspaceRowBoundsOutwardSpeedAndDemandsReturnFromOutside) {
  config::ServoConfig config = test::PandaConfig();
  model::ArmPoses poses;
  model::LinearJacobian J_E_B;
  model::ComputePoses(config.arm, test::Ready(), poses);
  model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J_E_B);
  const double radius = poses.X_BE.p.norm();
  test::RandomStates random(532);
  double before = -1.0;
  for (const double ahead : {-0.5, -0.003, 0.001, 0.01, 0.1}) {
    config.guard.workspace_radius = radius + config.guard.workspace_margin + 0.002 + ahead;
    MotionLimits limits;
    LimitJoints(config, test::Ready(), limits);
    limits.Add(WorkspaceRow(config, poses.X_BE.p, J_E_B, model::VecN::Zero(7)));
    ASSERT_EQ(limits.num_rows, 1);
    const LimitRow& row = limits.rows[0];
    const model::VecN dq = random.Joints(config.arm, 1.0);
    EXPECT_NEAR(row.a.dot(dq), (J_E_B * dq).dot(poses.X_BE.p / radius), 1e-12);
    EXPECT_EQ(row.b > 0.0, ahead > 0.0);
    EXPECT_GE(row.b, -0.02);
    EXPECT_GT(row.b, before) << "the further away, the faster";
    before = row.b;
  }
}

TEST(MotionLimitsTest, RowBeyondItsCapacityMarksTheLimitsAsNotKept) {
  MotionLimits limits;
  LimitJoints(test::PandaConfig(), test::Ready(), limits);
  for (int k = 0; k < MotionLimits::kMaxRows; ++k) {
    EXPECT_TRUE(limits.KeptBy(model::VecN::Zero(7)));
    limits.AddRow(model::VecN::Ones(7), 1.0);
    EXPECT_TRUE(limits.complete);
  }
  limits.AddRow(model::VecN::Ones(7), 1.0);
  EXPECT_EQ(limits.num_rows, MotionLimits::kMaxRows);
  EXPECT_FALSE(limits.KeptBy(model::VecN::Zero(7))) << "a limit that is left out is not kept";
  LimitJoints(test::PandaConfig(), test::Ready(), limits);
  EXPECT_TRUE(limits.KeptBy(model::VecN::Zero(7)));
  EXPECT_FALSE(limits.KeptBy(model::VecN::Constant(7, std::nan(""))));
  limits.AddRow(model::VecN::Ones(7), 1.0);
  EXPECT_FALSE(limits.KeptBy(model::VecN::Ones(7) * 0.2));
}

}  // namespace
}  // namespace fovea::barriers
