// SPDX-License-Identifier: Apache-2.0
// Every fault on an ideal arm: what is detected, after what time, and that the arm stops and stays at rest.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "tests/core/task/task_on_ideal_arm.hpp"

namespace fovea::task {
namespace {

using hal::Fault;
using hal::Mode;

// After a fault the arm must come to rest and the brakes close. Only a reset, then a new request, move it.
class FaultTest : public ServoTaskTest {
 protected:
  [[nodiscard]] double M(Eigen::Index joint) const {
    model::ArmPoses poses;
    model::ArmDynamics dynamics;
    model::ComputePoses(config_.arm, arm_->q(), poses);
    model::ComputeDynamics(config_.arm, poses, arm_->dq(), dynamics);
    return dynamics.M(joint, joint);
  }
  void ExpectStopsAndStays(Fault fault, int within_ticks) {
    EXPECT_EQ(outputs_.record.mode, Mode::kFault);
    EXPECT_EQ(outputs_.record.fault, fault) << hal::Name(outputs_.record.fault);
    const double at_the_fault = arm_->dq().norm();
    for (int i = 0; i < within_ticks; ++i) {
      Tick();
      EXPECT_LE(arm_->dq().norm(), at_the_fault * 1.05 + 1e-6) << "the arm must not speed up";
    }
    EXPECT_TRUE(outputs_.command().engage_brakes);
    EXPECT_EQ(outputs_.command().tau_cmd, hal::JointArray{});
    EXPECT_LT(arm_->dq().norm(), 1e-9);
    Tick([](ServoInputs& inputs) { inputs.request = Request::kTrack; });
    EXPECT_EQ(outputs_.record.mode, Mode::kFault) << "only a reset ends a fault";
  }
  void ExpectResetWorks() {
    Tick([](ServoInputs& inputs) { inputs.request = Request::kReset; });
    EXPECT_EQ(outputs_.record.mode, Mode::kBoot);
    EXPECT_FALSE(outputs_.command().engage_brakes);
    Run(500);
    EXPECT_EQ(outputs_.record.mode, Mode::kHold) << "nothing moves without a new request";
    Tick([](ServoInputs& inputs) { inputs.request = Request::kTrack; });
    Run(2500);
    EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
    EXPECT_EQ(outputs_.record.fault, Fault::kNone);
    EXPECT_LT(Error(), 0.05);
  }
  void SetUp() override {
    ServoTaskTest::SetUp();
    Run(500);  // during the approach
    ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
    ASSERT_GT(arm_->dq().norm(), 0.1);
  }
};

TEST_F(FaultTest, SilentArmRaisesArmLost) {
  for (int i = 0; i < config_.safety.arm_lost_ticks; ++i) {
    EXPECT_EQ(outputs_.record.mode, Mode::kTrack) << "tick " << i;
    const hal::JointArray before = outputs_.command().tau_cmd;
    Tick([](ServoInputs& inputs) { inputs.arm_status = hal::Status(hal::StatusCode::kTimeout); });
    if (outputs_.record.mode == Mode::kTrack) {
      for (std::size_t k = 0; k < 7; ++k) {
        EXPECT_NEAR(outputs_.command().tau_cmd[k], before[k], 1.0 + 1e-9) << "the last command is held";
      }
    }
  }
  EXPECT_EQ(outputs_.record.fault, Fault::kArmLost);
  // The arm stays silent: the torque fades at its rate limit, and the brakes close when it is zero.
  int ticks = 0;
  while (!outputs_.command().engage_brakes && ticks < 100) {
    const hal::JointArray before = outputs_.command().tau_cmd;
    Tick([](ServoInputs& inputs) { inputs.arm_status = hal::Status(hal::StatusCode::kTimeout); });
    ++ticks;
    for (std::size_t k = 0; k < 7; ++k) {
      EXPECT_LE(std::abs(outputs_.command().tau_cmd[k]), std::max(std::abs(before[k]) - 1.0, 0.0) + 1e-9);
    }
  }
  std::cout << "brakes " << ticks << " ms after the fault\n";
  EXPECT_TRUE(outputs_.command().engage_brakes) << "without states only the brakes can stop the arm";
  EXPECT_EQ(outputs_.command().tau_cmd, hal::JointArray{});
  ExpectStopsAndStays(Fault::kArmLost, 50);
  ExpectResetWorks();
}

// Lost states and then missed ticks, each for less than is allowed, count together as one silence.
TEST_F(FaultTest, LostStatesAndMissedTicksInARowRaiseArmLost) {
  const auto lose_then_miss = [this](int lost, int missed) {
    for (int i = 0; i < lost; ++i) {
      Tick([](ServoInputs& inputs) { inputs.arm_status = hal::Status(hal::StatusCode::kTimeout); });
    }
    Tick([missed](ServoInputs& inputs) { inputs.missed_ticks = missed; });
  };
  const int most = config_.safety.arm_lost_ticks;
  lose_then_miss(most / 2, most - most / 2 - 1);
  EXPECT_EQ(outputs_.record.fault, Fault::kNone);
  Run(50);
  lose_then_miss(most / 2, most - most / 2);
  EXPECT_EQ(outputs_.record.fault, Fault::kArmLost);
  ExpectStopsAndStays(Fault::kArmLost, 1500);
  ExpectResetWorks();
}

// A robot that recovered holds itself with its own torques. The brakes must stay closed all the same.
TEST_F(FaultTest, BrakesStayClosedWhenTheArmHoldsItselfAgain) {
  const auto silent = [](ServoInputs& inputs) { inputs.arm_status = hal::Status(hal::StatusCode::kTimeout); };
  for (int ticks = 0; ticks < 200 && !outputs_.command().engage_brakes; ++ticks) {
    Tick(silent);
  }
  ASSERT_EQ(outputs_.record.fault, Fault::kArmLost);
  for (int ticks = 0; ticks < 100; ++ticks) {
    Tick([](ServoInputs& inputs) { inputs.arm.tau_applied[1] = 30.0; });
    ASSERT_TRUE(outputs_.command().engage_brakes) << "tick " << ticks;
    ASSERT_EQ(outputs_.command().tau_cmd, hal::JointArray{}) << "tick " << ticks;
  }
  const hal::TickRecord& boot = Tick([](ServoInputs& inputs) {
    inputs.arm.tau_applied[1] = 30.0;
    inputs.request = Request::kReset;
  });
  EXPECT_EQ(boot.mode, Mode::kBoot);
  EXPECT_GE(boot.command.tau_cmd[1], 29.0 - 1e-9) << "the take-over causes no torque step";
}

TEST_F(FaultTest, RepeatedStateRaisesArmStale) {
  const hal::ArmState frozen = arm_->State();
  for (int i = 0; i <= config_.safety.arm_lost_ticks; ++i) {
    Tick([&](ServoInputs& inputs) { inputs.arm = frozen; });
  }
  ExpectStopsAndStays(Fault::kArmStale, 50);
  ExpectResetWorks();
}

TEST_F(FaultTest, NonFiniteSensorIsBridgedThenLatched) {
  for (int i = 0; i < config_.safety.non_finite_ticks; ++i) {
    Tick([](ServoInputs& inputs) { inputs.arm.q[3] = std::nan(""); });
    ASSERT_EQ(outputs_.record.mode, Mode::kTrack) << "bridged";
  }
  Tick();
  ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
  for (int i = 0; i <= config_.safety.non_finite_ticks; ++i) {
    Tick([](ServoInputs& inputs) { inputs.arm.dq[3] = std::numeric_limits<double>::infinity(); });
  }
  EXPECT_EQ(outputs_.record.fault_joint, 3);
  ExpectStopsAndStays(Fault::kNonFiniteSensor, 1500);
  ExpectResetWorks();
}

// A velocity jump that no motor can cause is not accepted: the servo bridges it, then latches a fault. Which
// fault depends on whether the position changes.
TEST_F(FaultTest, JumpingVelocityIsBridgedThenLatched) {
  const int bridged = config_.safety.non_finite_ticks;
  for (const bool hangs : {true, false}) {
    Start(config_);
    Run(500);
    ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
    Eigen::Index joint = 0;
    ASSERT_GT(arm_->dq().cwiseAbs().maxCoeff(&joint), 0.1);
    const auto k = static_cast<std::size_t>(joint);
    const double q = arm_->State().q[k];
    const double dq = arm_->dq()[joint];
    const double tau = outputs_.command().tau_cmd[k];
    const auto spoil = [&](ServoInputs& inputs) {
      inputs.arm.dq[k] = 0.0;
      inputs.arm.q[k] = hangs ? q : inputs.arm.q[k];
    };
    for (int i = 0; i < bridged; ++i) {
      EXPECT_EQ(Tick(spoil).fault, Fault::kNone) << "tick " << i;
    }
    const double k_v = 2.0 * config_.motion_law.zeta * config_.motion_law.omega_n;
    const double believed = M(joint) * k_v * std::fabs(dq);
    std::cout << "torque changes by " << outputs_.command().tau_cmd[k] - tau
              << " Nm; if the velocity were accepted, by " << believed << " Nm\n";
    EXPECT_LT(std::fabs(outputs_.command().tau_cmd[k] - tau), 0.6 * believed);
    Tick();
    EXPECT_EQ(outputs_.record.fault, Fault::kNone) << "the jump was short";
    for (int i = 0; i < 100; ++i) {
      Tick();
    }
    const double there = arm_->State().q[k];
    ASSERT_GT(std::fabs(arm_->dq()[joint]), 0.06);
    for (int i = 0; i <= bridged; ++i) {
      Tick([&](ServoInputs& inputs) {
        inputs.arm.dq[k] += 0.5;
        inputs.arm.q[k] = hangs ? there : inputs.arm.q[k];
      });
    }
    EXPECT_EQ(outputs_.record.fault, hangs ? Fault::kArmStale : Fault::kJointVelocity);
    EXPECT_EQ(outputs_.record.fault_joint, joint);
  }
}

TEST_F(FaultTest, NonFiniteFeatureRaisesItsFault) {
  Tick([&](ServoInputs& inputs) {
    inputs.has_feature = true;
    inputs.feature = Measure();
    inputs.feature.s[1] = std::nan("");
  });
  ExpectStopsAndStays(Fault::kNonFiniteFeature, 1500);
  ExpectResetWorks();
}

TEST_F(FaultTest, RepeatedMissedDeadlinesRaiseDeadlineMissed) {
  Tick([](ServoInputs& inputs) { inputs.missed_ticks = 1; });
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack) << "a single miss is no fault";
  Tick([this](ServoInputs& inputs) { inputs.missed_ticks = config_.safety.missed_ticks; });
  ExpectStopsAndStays(Fault::kDeadlineMissed, 1500);
  ExpectResetWorks();
}

TEST_F(FaultTest, JointOutsideItsRangeRaisesJointPosition) {
  Tick([](ServoInputs& inputs) { inputs.arm.q[5] = 3.76; });
  EXPECT_EQ(outputs_.record.fault_joint, 5);
  ExpectStopsAndStays(Fault::kJointPosition, 1500);
}

TEST_F(FaultTest, TooFastJointRaisesJointVelocity) {
  Tick([](ServoInputs& inputs) { inputs.arm.dq[2] = -2.2; });
  EXPECT_EQ(outputs_.record.fault_joint, 2);
  ExpectStopsAndStays(Fault::kJointVelocity, 1500);
}

// The encoders of a jammed arm read the same to the last bit, as if they hung. Brakes are right for both.
TEST_F(FaultTest, JammedArmRaisesArmStale) {
  arm_->Jam();
  int ticks = 0;
  while (outputs_.record.mode != Mode::kFault && ticks++ < 3000) {
    Tick();
  }
  std::cout << "found after " << ticks << " ms\n";
  EXPECT_GE(outputs_.record.fault_joint, 0);
  ExpectStopsAndStays(Fault::kArmStale, 150);
}

TEST_F(FaultTest, PushRaisesContactExceptUnderTheFloatLaw) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.contact_torque_fraction = 0.05;
  camera_on_ = false;
  for (const config::MotionLawKind law :
       {config::MotionLawKind::kFloat, config::MotionLawKind::kComputedTorque}) {
    config.motion_law.kind = law;
    Start(config);
    Run(100);
    ASSERT_EQ(outputs_.record.mode, Mode::kHold);
    for (int i = 0; i < 80; ++i) {
      arm_->SetVelocity(arm_->dq() + 0.02 * model::VecN::Unit(7, 0));  // some 10 Nm
      Tick();
    }
    EXPECT_STREQ(hal::Name(outputs_.record.fault), law == config::MotionLawKind::kFloat ? "none" : "contact");
  }
}

// Spring laws are meant to give way, and an integral learns the load by itself: neither carries a load.
TEST_F(FaultTest, OnlyPositionHoldingLawsCarryALoad) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.following_error = 1.0;  // springs give way far
  camera_on_ = false;
  const auto pushed_to = [&](config::MotionLawKind law, double integral, double carried) {
    config.motion_law.kind = law;
    config.motion_law.integral = integral;
    config.safety.carried_torque_fraction = carried;
    Start(config);
    Run(300);
    const double stood = arm_->q()[0];
    for (int i = 0; i < 400; ++i) {
      arm_->SetVelocity(arm_->dq() + 0.005 * model::VecN::Unit(7, 0));  // some 3 Nm
      Tick();
    }
    EXPECT_EQ(outputs_.record.mode, Mode::kHold) << hal::Name(outputs_.record.fault);
    return arm_->q()[0] - stood;
  };
  for (const config::MotionLawKind law :
       {config::MotionLawKind::kPd, config::MotionLawKind::kJointImpedance}) {
    EXPECT_EQ(pushed_to(law, 0.0, 0.1), pushed_to(law, 0.0, 0.0));
  }
  for (const config::MotionLawKind law :
       {config::MotionLawKind::kComputedTorque, config::MotionLawKind::kOperationalSpace}) {
    const double springs = pushed_to(law, 0.0, 0.0);
    const double carried = pushed_to(law, 0.0, 0.1);
    std::cout << "gives way by " << springs << " rad, with the load compensated by " << carried << " rad\n";
    EXPECT_GT(springs, 1e-3);
    EXPECT_LT(carried, 0.6 * springs);
    EXPECT_GT(carried, 0.0);
    EXPECT_EQ(pushed_to(law, 2.0, 0.1), pushed_to(law, 2.0, 0.0));
  }
}

// Damping slows an arm that is pulled to a creep, not to rest: the brakes must not wait for brake_after_s.
TEST_F(FaultTest, StopUnderAPullEndsInTheBrakes) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.brake_after_s = 10.0;
  for (const double ddq : {0.0, 5.0}) {
    Start(config);
    Run(500);
    Tick([&](ServoInputs& inputs) { inputs.missed_ticks = config.safety.missed_ticks; });
    ASSERT_EQ(outputs_.record.fault, Fault::kDeadlineMissed);
    int ticks = 0;
    for (; ticks < 3000 && !outputs_.command().engage_brakes; ++ticks) {
      arm_->SetVelocity(arm_->dq() + 1e-3 * ddq * model::VecN::Unit(7, 1));
      Tick();
    }
    std::cout << "pulled by " << ddq << " rad/s^2: brakes after " << ticks << " ms\n";
    EXPECT_TRUE(outputs_.command().engage_brakes);
    EXPECT_LT(ticks, ddq > 0.0 ? 350 : 1000);
  }
}

// Without the contact observer a jammed arm is detected later, by its following error.
TEST_F(FaultTest, ArmOffItsReferenceRaisesNotFollowing) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.contact_torque_fraction = config.safety.contact_sudden_fraction = 1e3;
  config.safety.non_finite_ticks = 10'000;  // and constant readings do not count
  Start(config);
  Run(500);
  arm_->Jam();
  int ticks = 0;
  while (outputs_.record.mode != Mode::kFault && ticks++ < 3000) {
    Tick();
  }
  std::cout << "found after " << ticks << " ms\n";
  EXPECT_GE(outputs_.record.fault_joint, 0);
  ExpectStopsAndStays(Fault::kNotFollowing, 150);  // the torque has grown and fades at its rate limit
}

}  // namespace
}  // namespace fovea::task
