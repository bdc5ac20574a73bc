// SPDX-License-Identifier: Apache-2.0
// The swing about a disc whose two poses are not told apart.
#include "firmware/core/control/swing.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"

namespace fovea::control {
namespace {

using model::Vec3;
using model::VecN;

class SwingTest : public testing::Test {
 protected:
  SwingTest() : config_(test::PandaConfig()), q_(test::Ready()) {
    Place();
    normal_B_ = X_BC_.R * model::RotationOf({0.3, -0.2, 0.0}) * Vec3::UnitZ();
    p_BO_ = X_BC_ * Vec3(0.01, -0.005, 0.40);
    dq_0_.setZero(q_.size());
  }
  void Place() {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q_, poses);
    X_BC_ = poses.X_BE * config_.X_EC;
    model::ComputeJacobian(config_.arm, poses, config_.X_EC, J_C_);
  }
  [[nodiscard]] SwungDisc Disc() const {
    return {.radius = 0.04,
            .p_CO = X_BC_.Inverse() * p_BO_,
            .p_CO_star = {0.0, 0.0, 0.40},
            .v_BO = v_BO_,
            .normal_C = X_BC_.R.transpose() * normal_B_,
            .J_C = J_C_,
            .limits = limits_};
  }
  // One tick: the wish that was added.
  VecN Tick() {
    MotionTask task;
    task.dq_0 = dq_0_;
    AddSwing(Disc(), swing_, task);
    return task.dq_0 - dq_0_;
  }

  config::ServoConfig config_;
  VecN q_;
  VecN dq_0_;
  model::Pose X_BC_;
  model::Mat6N J_C_;
  Vec3 p_BO_;
  Vec3 v_BO_ = Vec3::Zero();
  Vec3 normal_B_;
  hal::LimitSet limits_ = 0;
  Swing swing_;
};

// The line of sight turns, out of the plane of the normals, and the disc stays where it is in the picture.
TEST_F(SwingTest, TurnsTheLineOfSightAndKeepsTheFeature) {
  const Vec3 p_CO = Disc().p_CO;
  const Vec3 ray_B = (p_BO_ - X_BC_.p).normalized();
  const double tilt = ray_B.dot(normal_B_);
  ASSERT_TRUE(IsWorthASwing(Disc(), swing_));
  for (int i = 0; i < 1000; ++i) {
    q_ += hal::kTickPeriodS * Tick();
    Place();
  }
  const Vec3 ray_after_B = (p_BO_ - X_BC_.p).normalized();
  const double turned = std::acos(ray_B.dot(ray_after_B));
  std::cout << "after 1 s the line of sight has turned by " << turned << " rad; the disc is "
            << 1e3 * (Disc().p_CO - p_CO).norm() << " mm off its place in C, its tilt's cosine changed by "
            << std::fabs(ray_after_B.dot(normal_B_) - tilt) << "\n";
  EXPECT_NEAR(turned, swing_.angle, 0.01);
  EXPECT_GT(turned, 0.1);
  EXPECT_LT((Disc().p_CO - p_CO).norm(), 1e-3);
  EXPECT_LT(std::fabs(ray_after_B.dot(normal_B_) - tilt), 0.01);
}

TEST_F(SwingTest, BeginsSmoothlyAndEndsAfterABoundedAngle) {
  const double first = Tick().norm();
  int ticks = 1;
  double most = first;
  for (; IsWorthASwing(Disc(), swing_) && ticks < 10'000; ++ticks) {
    const double now = Tick().norm();
    EXPECT_LT(now - most, 1.01 * first) << "tick " << ticks;
    most = std::max(most, now);
  }
  EXPECT_GT(most, 100.0 * first);
  EXPECT_LT(ticks, 4000);
  EXPECT_NEAR(swing_.angle, 0.4, 1e-3);
}

TEST_F(SwingTest, GoesToTheSideOfTheWishAndTurnsBackBeforeALimit) {
  const VecN plain = Tick();
  swing_ = Swing{};
  dq_0_ = -100.0 * plain;
  VecN added = Tick();
  EXPECT_GT(added.dot(dq_0_), 0.0);
  limits_ = hal::Bit(hal::Limit::kJointPosition);
  const VecN before = added;
  int ticks = 0;
  for (; added.dot(before) > 0.0 && ticks < 1000; ++ticks) {
    added = Tick();
  }
  EXPECT_NEAR(ticks, 201, 2);
}

TEST_F(SwingTest, IsNotWorthItWithoutDoubtOrFarAwayOrForAMovingDisc) {
  EXPECT_TRUE(IsWorthASwing(Disc(), swing_));
  v_BO_ = {0.0, 0.06, 0.0};
  EXPECT_FALSE(IsWorthASwing(Disc(), swing_));
  v_BO_.setZero();
  p_BO_ = X_BC_ * Vec3(0.04, 0.0, 0.40);
  EXPECT_FALSE(IsWorthASwing(Disc(), swing_)) << "the law's own motion tells more";
  p_BO_ = X_BC_ * Vec3(0.0, 0.0, 0.40);
  normal_B_ = X_BC_.R.col(2);
  EXPECT_FALSE(IsWorthASwing(Disc(), swing_)) << "both poses are the same";
  normal_B_ = Vec3::Constant(HUGE_VAL);
  EXPECT_FALSE(IsWorthASwing(Disc(), swing_));
}

}  // namespace
}  // namespace fovea::control
