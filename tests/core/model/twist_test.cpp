// SPDX-License-Identifier: Apache-2.0
// THEORY B4: the camera's twist as the end effector's in the base frame, against the arm's own Jacobians and
// against differences of poses.
#include "firmware/core/model/twist.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <iostream>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::model {
namespace {

std::array<double, 7> Seven(const Pose& X) {
  const Eigen::Quaterniond q(X.R);
  return {X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
}

// The mount of the course exercises, +90 degrees about z, with the lever arm that they omit.
Pose Mount() {
  Pose X_EC;
  X_EC.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  X_EC.p = {0.05, 0.0, 0.04};
  return X_EC;
}

TEST(TwistTest, CameraJacobianTwistMapsToTheHandJacobianTwist) {
  const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/panda.toml");
  test::RandomStates random(31);
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    const VecN q = random.Position(robot.model);
    const VecN dq = random.Joints(robot.model, 1.0);
    ArmPoses poses;
    ComputePoses(robot.model, q, poses);
    Mat6N J_C;
    Mat6N J_B;
    ComputeJacobian(robot.model, poses, Mount(), J_C);
    ComputeBaseJacobian(robot.model, poses, J_B);
    Vec6 V_BE_B;
    ASSERT_TRUE(CameraToBaseTwist(Seven(poses.X_BE), Mount(), J_C * dq, V_BE_B));
    worst = std::max(worst, (V_BE_B - J_B * dq).norm());
  }
  std::cout << "worst difference over 500 states: " << worst << "\n";
  EXPECT_LT(worst, 1e-13);
}

// A camera that only turns moves the hand by the lever arm.
TEST(TwistTest, RotationAloneMovesTheOtherFrameByTheLeverArm) {
  Vec6 V_BC_C = Vec6::Zero();
  V_BC_C[5] = 1.0;  // about the camera's z axis
  Vec6 V_BE_B;
  ASSERT_TRUE(CameraToBaseTwist({0.4, 0.1, 0.5, 1.0, 0.0, 0.0, 0.0}, Mount(), V_BC_C, V_BE_B));
  Vec6 expected;
  expected << 0.0, -0.05, 0.0, 0.0, 0.0, 1.0;  // p_EC x w
  EXPECT_LT((V_BE_B - expected).norm(), 1e-15);
}

TEST(TwistTest, MatchesFiniteDifferencesOfPoses) {
  test::RandomStates random(32);
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    const Pose X_BE{Eigen::Quaterniond::UnitRandom().toRotationMatrix(), random.Vector(0.5)};
    const Pose X_EC{Eigen::Quaterniond::UnitRandom().toRotationMatrix(), random.Vector(0.1)};
    Vec6 V;
    V << random.Vector(0.3), random.Vector(1.0);
    constexpr double kDt = 1e-6;
    const auto moved = [&](double dt) {
      const Vec3 turn = V.tail<3>() * dt;
      const Pose step{Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix(), V.head<3>() * dt};
      return X_BE * X_EC * step * X_EC.Inverse();
    };
    const Pose after = moved(kDt);
    const Pose before = moved(-kDt);
    Vec6 V_BE_B;
    ASSERT_TRUE(CameraToBaseTwist(Seven(X_BE), X_EC, V, V_BE_B));
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.R * before.R.transpose()));
    Vec6 rate;
    rate << (after.p - before.p) / (2.0 * kDt), turn.angle() * turn.axis() / (2.0 * kDt);
    worst = std::max(worst, (V_BE_B - rate).norm());
  }
  std::cout << "worst difference from the poses' rate: " << worst << "\n";
  EXPECT_LT(worst, 1e-8);
}

TEST(TwistTest, RefusesAnInvalidPose) {
  Vec6 V = Vec6::Ones();
  const double nan = std::nan("");
  Vec6 out = Vec6::Constant(7.0);
  EXPECT_FALSE(CameraToBaseTwist({0, 0, 0, 0, 0, 0, 0}, Mount(), V, out));
  EXPECT_FALSE(CameraToBaseTwist({0, nan, 0, 1, 0, 0, 0}, Mount(), V, out));
  EXPECT_FALSE(CameraToBaseTwist({0, 0, 0, 1, nan, 0, 0}, Mount(), V, out));
  V[3] = nan;
  EXPECT_FALSE(CameraToBaseTwist({0, 0, 0, 1, 0, 0, 0}, Mount(), V, out));
  EXPECT_EQ(out, Vec6::Constant(7.0)) << "untouched";
}

}  // namespace
}  // namespace fovea::model
