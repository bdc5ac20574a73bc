// SPDX-License-Identifier: Apache-2.0
// The stages of the stop after a fault: damped, let go (the torque fades), braked.
#include "firmware/core/guard/fault_stop.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/core/model/kinematics.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"

namespace fovea::guard {
namespace {

using Stage = FaultStop::Stage;

model::ArmDynamics DynamicsAt(const model::ArmModel& arm, const model::VecN& q, const model::VecN& dq) {
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(arm, q, poses);
  model::ComputeDynamics(arm, poses, dq, dynamics);
  return dynamics;
}

hal::ArmCommand CommandOf(const model::VecN& tau) {
  hal::ArmCommand command;
  command.num_joints = static_cast<int>(tau.size());
  command.tau_cmd = model::ToArray(tau);
  return command;
}

TEST(FaultStopTest, DampedStopDecaysTheSpeedExponentially) {
  const config::ServoConfig config = test::PandaConfig();
  test::IdealArm arm(config.arm, test::Ready());
  model::VecN start(7);
  start << 0.5, -0.4, 0.6, 0.5, -0.7, 0.4, 0.8;
  arm.SetVelocity(start);
  double energy_before = HUGE_VAL;
  for (int tick = 0; tick < 500; ++tick) {
    const model::ArmDynamics dynamics = DynamicsAt(config.arm, arm.q(), arm.dq());
    const double energy = 0.5 * arm.dq().dot(dynamics.M * arm.dq());
    EXPECT_LT(energy, energy_before) << "the arm never speeds up";
    energy_before = energy;
    model::VecN tau;
    DampedStop(config.safety.fault_damping, dynamics, arm.dq(), tau);
    arm.Apply(CommandOf(tau));
    arm.Step();
  }
  EXPECT_LT(arm.dq().norm(), start.norm() * std::exp(-0.5 * config.safety.fault_damping) * 2.0);
}

class FaultStopStageTest : public testing::Test {
 protected:
  // One tick with every joint at `speed` [rad/s].
  Stage Tick(double speed, bool blind = false, double since_s = 0.01) {
    const model::VecN dq = model::VecN::Constant(7, speed);
    StopAfterFault(config_.safety, DynamicsAt(config_.arm, test::Ready(), dq), dq, blind, since_s, stop_,
                   tau_);
    return stop_.stage;
  }

  const config::ServoConfig config_ = test::PandaConfig();
  FaultStop stop_;
  model::VecN tau_;
};

TEST_F(FaultStopStageTest, MovingArmIsDampedUntilSlow) {
  EXPECT_EQ(Tick(0.5), Stage::kDamped);
  EXPECT_GT(tau_.norm(), 0.0);
  EXPECT_EQ(Tick(0.99 * config_.safety.brake_velocity), Stage::kLetGo);
  EXPECT_EQ(tau_.norm(), 0.0);
}

TEST_F(FaultStopStageTest, WithoutVelocitiesDampingIsSkipped) {
  EXPECT_EQ(Tick(0.5, true), Stage::kLetGo);
  EXPECT_EQ(tau_.norm(), 0.0);
}

TEST_F(FaultStopStageTest, DampingEndsAtTheTimeLimit) {
  EXPECT_EQ(Tick(0.5, false, config_.safety.brake_after_s), Stage::kDamped);
  EXPECT_EQ(Tick(0.5, false, config_.safety.brake_after_s + 1e-3), Stage::kLetGo);
}

TEST_F(FaultStopStageTest, DampingEndsWhenTheArmSpeedsUp) {
  EXPECT_EQ(Tick(0.5), Stage::kDamped);
  EXPECT_EQ(Tick(0.69), Stage::kDamped) << "noise of the velocities does not count";
  EXPECT_EQ(Tick(0.72), Stage::kLetGo);
}

TEST_F(FaultStopStageTest, DampingEndsWhenTheArmDoesNotSlowDown) {
  int ticks = 0;
  while (Tick(1.0) == Stage::kDamped && ticks < 1000) {
    ++ticks;
  }
  // exp(-0.3 * 10 * t) = 1 - 0.2
  EXPECT_NEAR(ticks, -std::log(0.8) / 3.0 * 1e3, 2.0);
}

TEST_F(FaultStopStageTest, BrakesCloseAtZeroTorqueAndStayClosed) {
  Tick(0.5, true);
  model::VecN sent = model::VecN::Constant(7, 3.0);
  CloseBrakes(sent, stop_);
  EXPECT_EQ(stop_.stage, Stage::kLetGo) << "the torque fades out first";
  sent.setZero();
  CloseBrakes(sent, stop_);
  EXPECT_EQ(stop_.stage, Stage::kBraked);
  EXPECT_EQ(Tick(0.5), Stage::kBraked);
  EXPECT_EQ(tau_.norm(), 0.0);
  CloseBrakes(model::VecN::Constant(7, 3.0), stop_);
  EXPECT_EQ(stop_.stage, Stage::kBraked);
}

TEST_F(FaultStopStageTest, ZeroTorqueWhileDampingDoesNotCloseTheBrakes) {
  Tick(0.5);
  CloseBrakes(model::VecN::Zero(7), stop_);
  EXPECT_EQ(stop_.stage, Stage::kDamped);
}

}  // namespace
}  // namespace fovea::guard
