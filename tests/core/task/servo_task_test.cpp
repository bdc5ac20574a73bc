// SPDX-License-Identifier: Apache-2.0
// The whole task on an ideal arm: it closes the loop, and reacts to bad inputs.
#include "firmware/core/task/servo_task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <random>

#include "tests/core/task/task_on_ideal_arm.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::task {
namespace {

using hal::Mode;

TEST_F(ServoTaskTest, BootsHoldsAndTracksToTheGoal) {
  EXPECT_EQ(Tick().mode, Mode::kBoot);
  EXPECT_EQ(Run(40).mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kNoTarget);
  EXPECT_EQ(Run(200).mode, Mode::kTrack);
  Run(5000);
  std::cout << "error after 5.2 s: " << 1e3 * Error() << " mm\n";
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  EXPECT_LT(Error(), 1e-4);
}

// With constant gain, after the smooth start and while no limit acts: e(t) = e0 exp(-lambda t).
TEST_F(ServoTaskTest, TheErrorDecaysExponentially) {
  while (Tick().mode != Mode::kTrack) {
  }
  Run(600);  // past the smooth start
  model::Vec3 e0(outputs_.record.e[0], outputs_.record.e[1], outputs_.record.e[2]);
  double worst = 0.0;
  for (int ms = 1; ms <= 1000; ++ms) {
    const hal::TickRecord& r = Tick();
    const double expected = e0.norm() * std::exp(-config_.law.lambda * 1e-3 * ms);
    const double now = model::Vec3(r.e[0], r.e[1], r.e[2]).norm();
    worst = std::max(worst, std::abs(now / expected - 1.0));
    EXPECT_EQ(r.limits_active & ~hal::Bit(hal::Limit::kJointJerk), 0U);
  }
  std::cout << "worst departure from exp(-lambda t) within 1 s: " << 100.0 * worst << " %\n";
  EXPECT_LT(worst, 0.10);
}

// Boot may end in its first tick with a sound arm: the reference must start at the arm's position even then.
TEST_F(ServoTaskTest, BootOfOneTickHoldsTheArmWhereItIs) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.boot_ticks = 1;
  Start(config);
  for (int tick = 0; tick < 50; ++tick) {
    EXPECT_EQ(Tick().fault, hal::Fault::kNone);
    EXPECT_LT((task_.state().reference.q - task_.state().q).lpNorm<Eigen::Infinity>(), 1e-3);
  }
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
}

// An arm that still drifts when Boot accepts it as at rest is braked within the limits, not stopped at once.
TEST_F(ServoTaskTest, TakesOverADriftingArmWithoutAStep) {
  camera_on_ = false;
  const model::VecN drift = model::VecN::Constant(config_.arm.num_joints, 0.9 * config_.safety.boot_velocity);
  arm_->SetVelocity(drift);
  double most_rate = 0.0;  // share of the torque's allowed rate
  hal::TickRecord before = Tick();
  while (before.mode == Mode::kBoot) {
    before = Tick();
    ASSERT_LT(ticks_, 100);
  }
  for (int tick = 0; tick < 100; ++tick) {
    const hal::TickRecord& now = Tick();
    for (std::size_t i = 0; i < 7; ++i) {
      const double step = now.command.tau_cmd[i] - before.command.tau_cmd[i];
      most_rate = std::max(most_rate, std::fabs(step) / (1e-3 * config_.arm.joints[i].dtau_max));
    }
    before = now;
  }
  std::cout << "torque rate at most " << most_rate << " of what is allowed\n";
  EXPECT_LT(most_rate, 0.6);
  EXPECT_EQ(before.mode, Mode::kHold);
  EXPECT_LT(arm_->dq().norm(), 1e-3);
}

TEST_F(ServoTaskTest, HoldsUntilAskedWhenAutoTrackIsOff) {
  config::ServoConfig config = test::PandaConfig();
  config.auto_track = false;
  Start(config);
  EXPECT_EQ(Run(1000).mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kNotAsked);
  const model::VecN before = arm_->q();
  Run(500);
  EXPECT_LT((arm_->q() - before).norm(), 1e-9) << "the arm stands still";
  Tick([](ServoInputs& inputs) { inputs.request = Request::kTrack; });
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  Run(300);
  Tick([](ServoInputs& inputs) { inputs.request = Request::kHold; });
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  Run(500);
  EXPECT_LT(arm_->dq().norm(), 1e-3) << "the arm stands again";
}

TEST_F(ServoTaskTest, CoastsThroughAShortGapAndHoldsAfterALongOne) {
  Run(500);
  ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
  camera_on_ = false;
  Run(300);
  EXPECT_EQ(outputs_.record.mode, Mode::kCoast);
  camera_on_ = true;
  Run(100);
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  camera_on_ = false;
  Run(1500);
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kTargetLost);
  EXPECT_LT(arm_->dq().norm(), 1e-3);
  camera_on_ = true;
  Run(300);
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
}

// The camera clock jumped: a measurement from the future is rejected, and does not block later ones.
TEST_F(ServoTaskTest, RejectsAMeasurementFromTheFuture) {
  Run(500);
  ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
  camera_on_ = false;
  Tick([this](ServoInputs& inputs) {
    inputs.has_feature = true;
    inputs.feature = Measure();
    inputs.feature.stamp_ns += 3600 * hal::kNsPerSecond;
  });
  Run(1500);
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kTargetLost);
  camera_on_ = true;
  Run(300);
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
}

TEST_F(ServoTaskTest, RejectsAMeasurementAFewTicksAhead) {
  Run(500);
  ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
  camera_on_ = false;
  Run(20);
  Tick([this](ServoInputs& inputs) {
    inputs.has_feature = true;
    inputs.feature = Measure();
    inputs.feature.stamp_ns = inputs.arm.stamp_ns + 3 * hal::kTickPeriodNs;
  });
  EXPECT_GE(outputs_.record.feature_age_ns, 20 * hal::kTickPeriodNs);
}

TEST_F(ServoTaskTest, HoldsWithAReasonWhenTheGoalIsOutOfReach) {
  target_ = X_BC() * model::Vec3(0.0, 0.0, 1.15);  // visible, but the goal is outside the workspace
  target_.x() += 0.6;
  Run(12000);
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kGoalUnreachable);
  EXPECT_LT(arm_->dq().norm(), 1e-2);
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, arm_->q(), poses);
  EXPECT_LE(poses.X_BE.p.norm(), config_.guard.workspace_radius + 1e-3);
}

// The goal is in reach, but the path follows the workspace boundary all the way: this takes long, and is no
// reason to give up.
TEST_F(ServoTaskTest, CreepsAlongTheEdgeToAGoalThatIsJustInReach) {
  target_ = X_BC() * model::Vec3(0.0, 0.0, 1.15);
  target_.x() += 0.5;
  Run(12000);
  const double after_12_s = Error();
  Run(12000);
  std::cout << "off the goal: " << 1e3 * after_12_s << " mm after 12 s, " << 1e3 * Error()
            << " mm after 24 s\n";
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  EXPECT_LT(after_12_s, 2e-3);
  EXPECT_LT(Error(), 0.8 * after_12_s);
}

// Random bad inputs in any order: the command stays finite, within range and within rate.
TEST_F(ServoTaskTest, AnyInputKeepsTheTorqueLimits) {
  std::mt19937_64 engine(51);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double odd[] = {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, -1e300, 0.0, 1e6};
  for (int k = 0; k < test::Repetitions(60'000); ++k) {
    hal::JointArray in_force = outputs_.command().tau_cmd;
    Tick([&](ServoInputs& inputs) {
      const double dice = uniform(engine);
      const auto joint = static_cast<std::size_t>(k % 7);
      const double value = odd[static_cast<std::size_t>(k / 7) % 6];
      if (dice < 0.02) {
        inputs.arm.q[joint] = value;
      } else if (dice < 0.04) {
        inputs.arm.dq[joint] = value;
      } else if (dice < 0.05) {
        inputs.has_feature = true;
        inputs.feature = Measure();
        inputs.feature.s[joint % 3] = value;
      } else if (dice < 0.06) {
        inputs.arm_status = hal::Status(hal::StatusCode::kDisconnected);
      } else if (dice < 0.07) {
        inputs.missed_ticks = k % 30;
      } else if (dice < 0.08) {
        inputs.arm.stamp_ns -= 5 * hal::kNsPerMs;
      } else if (dice < 0.15) {
        inputs.request = Request::kReset;
      } else if (dice < 0.16) {
        inputs.arm.tau_applied[joint] = value;
        if (std::abs(value) <= config_.arm.joints[joint].tau_max) {
          in_force[joint] = value;  // wrong, but plausible
        }
      } else if (dice < 0.17) {
        inputs.has_feature = true;
        inputs.feature.cov_s.fill(value);
      }
    });
    const hal::ArmCommand& command = outputs_.command();
    for (std::size_t i = 0; i < 7; ++i) {
      ASSERT_TRUE(std::isfinite(command.tau_cmd[i])) << "tick " << k;
      ASSERT_LE(std::abs(command.tau_cmd[i]), config_.arm.joints[i].tau_max);
      ASSERT_LE(std::abs(command.tau_cmd[i] - in_force[i]), 1e-3 * config_.arm.joints[i].dtau_max + 1e-9)
          << "tick " << k << ", joint " << i + 1;
      ASSERT_TRUE(!command.engage_brakes || command.tau_cmd[i] == 0.0);
    }
  }
}

// Gains that suit one law may be too high for another: the servo then refuses the change of law.
TEST_F(ServoTaskTest, LawThatTheGainsDoNotFitDoesNotTakeOver) {
  for (const double k_v : {0.1, 1.0}) {  // on 0.005 kg m^2: 20 and 204 1/s
    config::ServoConfig config = test::PandaConfig();
    config.motion_law.k_v[6] = k_v;
    Start(config);
    Run(200);
    const auto ask = [](ServoInputs& inputs) {
      inputs.change_law = true;
      inputs.law = config::MotionLawKind::kPd;
    };
    Tick(ask);
    EXPECT_EQ(task_.state().law_state.kind,
              k_v < 0.5 ? config::MotionLawKind::kPd : config::MotionLawKind::kComputedTorque);
  }
}

TEST_F(ServoTaskTest, TheSameInputsGiveTheSameBits) {
  std::vector<ServoInputs> inputs;
  std::vector<hal::TickRecord> first;
  for (int k = 0; k < 2000; ++k) {
    Tick([&](ServoInputs& in) { inputs.push_back(in); });
    first.push_back(outputs_.record);
  }
  ServoTask again;
  ASSERT_TRUE(again.Init(config_).ok());
  ServoOutputs outputs;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    again.Step(inputs[k], outputs);
    ASSERT_EQ(outputs.record.mode, first[k].mode);
    ASSERT_EQ(outputs.record.command.tau_cmd, first[k].command.tau_cmd);
    ASSERT_EQ(outputs.record.q_cmd, first[k].q_cmd);
    ASSERT_EQ(outputs.record.s, first[k].s);
  }
}

}  // namespace
}  // namespace fovea::task
