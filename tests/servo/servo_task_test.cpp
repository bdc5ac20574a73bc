// The task as a whole, on an arm that obeys the model: it closes the loop, and it reacts to all that goes
// wrong.
#include "fovea/servo/servo_task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <random>

#include "support/ideal_arm.hpp"
#include "support/panda.hpp"
#include "support/repetitions.hpp"

namespace fovea::servo {
namespace {

using hal::Fault;
using hal::Mode;

constexpr int kLatencyMs = 40;
constexpr int kFrameMs = 33;

// A task, an ideal arm, and a camera that measures without error, 40 ms late.
class ServoTaskTest : public testing::Test {
 protected:
  void Start(const ServoConfig& config) {
    config_ = config;
    ASSERT_TRUE(task_.Init(config).ok());
    model::VecN q = test::Ready();
    q[0] -= 0.3;
    arm_ = std::make_unique<test::IdealArm>(config.arm, q);
    target_ = X_BC() * model::Vec3(-0.10, 0.08, 0.55);
  }
  void SetUp() override { Start(test::PandaConfig()); }

  model::Pose X_BC() const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, arm_->q(), poses);
    return poses.X_BE * config_.X_EC;
  }

  // One tick; `change` may spoil the inputs.
  const hal::TickRecord& Tick(const std::function<void(ServoInputs&)>& change = {}) {
    ServoInputs inputs;
    inputs.arm = arm_->State();
    if (camera_on_ && ticks_ >= kLatencyMs && (ticks_ - kLatencyMs) % kFrameMs == 0) {
      inputs.has_feature = true;
      inputs.feature = pending_.at(static_cast<std::size_t>(ticks_ - kLatencyMs));
    }
    pending_.push_back(Measure());
    if (change) {
      change(inputs);
    }
    task_.Step(inputs, outputs_);
    arm_->Apply(outputs_.command());
    arm_->Step();
    ++ticks_;
    return outputs_.record;
  }
  const hal::TickRecord& Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      Tick();
    }
    return outputs_.record;
  }

  hal::FeatureMeasurement Measure() const {
    hal::FeatureMeasurement m;
    m.stamp_ns = arm_->State().stamp_ns;
    m.sequence = static_cast<std::uint64_t>(ticks_);
    m.found = true;
    m.confidence = 1.0;
    m.dim = 3;
    const model::Vec3 s = (X_BC().Inverse() * target_) / config_.feature.radius;
    for (int i = 0; i < 3; ++i) {
      m.s[static_cast<std::size_t>(i)] = s[i];
      m.cov_s[static_cast<std::size_t>(i * hal::kMaxFeatureDim + i)] = 1e-6;
    }
    return m;
  }
  double Error() const { return (X_BC().Inverse() * target_ - config_.feature.p_CO_C_star).norm(); }

  ServoConfig config_;
  ServoTask task_;
  ServoOutputs outputs_;
  std::unique_ptr<test::IdealArm> arm_;
  model::Vec3 target_;
  bool camera_on_ = true;
  int ticks_ = 0;
  std::vector<hal::FeatureMeasurement> pending_;
};

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

TEST_F(ServoTaskTest, HoldsUntilAskedWhenAutoTrackIsOff) {
  ServoConfig config = test::PandaConfig();
  config.auto_track = false;
  Start(config);
  EXPECT_EQ(Run(1000).mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kNotAsked);
  const model::VecN before = arm_->q();
  Run(500);
  EXPECT_LT((arm_->q() - before).norm(), 1e-9) << "it stands still";
  Tick([](ServoInputs& inputs) { inputs.request = Request::kTrack; });
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  Run(300);
  Tick([](ServoInputs& inputs) { inputs.request = Request::kHold; });
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  Run(500);
  EXPECT_LT(arm_->dq().norm(), 1e-3) << "and stands again";
}

TEST_F(ServoTaskTest, CoastsThroughAGapAndGivesUpAfterLong) {
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

// A camera whose clock jumped: what it says of the future is left out, and does not stand in the way later.
TEST_F(ServoTaskTest, AMeasurementFromTheFutureIsNoMeasurement) {
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

TEST_F(ServoTaskTest, HoldsWithAReasonWhenTheGoalIsOutOfReach) {
  target_ = X_BC() * model::Vec3(0.0, 0.0, 1.15);  // seen, but 0.4 m before it is outside the workspace
  target_.x() += 0.5;
  Run(12000);
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kGoalUnreachable);
  EXPECT_LT(arm_->dq().norm(), 1e-2);
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, arm_->q(), poses);
  EXPECT_LE(poses.X_BE.p.norm(), config_.guard.workspace_radius + 1e-3);
}

// After a fault the arm must come to rest, the brakes close, and nothing but a reset and a new approach move
// it.
class FaultTest : public ServoTaskTest {
 protected:
  void ExpectStopsAndStays(Fault fault, int within_ticks) {
    EXPECT_EQ(outputs_.record.mode, Mode::kFault);
    EXPECT_EQ(outputs_.record.fault, fault) << hal::Name(outputs_.record.fault);
    const double at_the_fault = arm_->dq().norm();
    for (int i = 0; i < within_ticks; ++i) {
      Tick();
      EXPECT_LE(arm_->dq().norm(), at_the_fault * 1.05 + 1e-6) << "it must not speed up";
    }
    EXPECT_TRUE(outputs_.command().engage_brakes);
    EXPECT_EQ(outputs_.command().tau_cmd, hal::JointArray{});
    EXPECT_LT(arm_->dq().norm(), 1e-9);
    Tick([](ServoInputs& inputs) { inputs.request = Request::kTrack; });
    EXPECT_EQ(outputs_.record.mode, Mode::kFault) << "only a reset leaves it";
  }
  void ExpectResetWorks() {
    Tick([](ServoInputs& inputs) { inputs.request = Request::kReset; });
    EXPECT_EQ(outputs_.record.mode, Mode::kBoot);
    EXPECT_FALSE(outputs_.command().engage_brakes);
    Run(3000);
    EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
    EXPECT_EQ(outputs_.record.fault, Fault::kNone);
    EXPECT_LT(Error(), 0.05);
  }
  void SetUp() override {
    ServoTaskTest::SetUp();
    Run(500);  // in full approach
    ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
    ASSERT_GT(arm_->dq().norm(), 0.1);
  }
};

TEST_F(FaultTest, ArmLost) {
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
  // It stays silent: the torque goes at its rate, and the brakes close when it is gone.
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
  EXPECT_TRUE(outputs_.command().engage_brakes) << "blind: only the brakes are left";
  EXPECT_EQ(outputs_.command().tau_cmd, hal::JointArray{});
  ExpectStopsAndStays(Fault::kArmLost, 50);
  ExpectResetWorks();
}

TEST_F(FaultTest, ArmStale) {
  const hal::ArmState frozen = arm_->State();
  for (int i = 0; i <= config_.safety.arm_lost_ticks; ++i) {
    Tick([&](ServoInputs& inputs) { inputs.arm = frozen; });
  }
  ExpectStopsAndStays(Fault::kArmStale, 50);
  ExpectResetWorks();
}

TEST_F(FaultTest, NonFiniteSensorIsBridgedThenLatched) {
  for (const int joint : {3}) {
    for (int i = 0; i < config_.safety.non_finite_ticks; ++i) {
      Tick([&](ServoInputs& inputs) { inputs.arm.q[static_cast<std::size_t>(joint)] = std::nan(""); });
      ASSERT_EQ(outputs_.record.mode, Mode::kTrack) << "bridged";
    }
    Tick();
    ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
    for (int i = 0; i <= config_.safety.non_finite_ticks; ++i) {
      Tick([&](ServoInputs& inputs) {
        inputs.arm.dq[static_cast<std::size_t>(joint)] = std::numeric_limits<double>::infinity();
      });
    }
    EXPECT_EQ(outputs_.record.fault_joint, joint);
  }
  ExpectStopsAndStays(Fault::kNonFiniteSensor, 1500);
  ExpectResetWorks();
}

TEST_F(FaultTest, NonFiniteFeature) {
  Tick([&](ServoInputs& inputs) {
    inputs.has_feature = true;
    inputs.feature = Measure();
    inputs.feature.s[1] = std::nan("");
  });
  ExpectStopsAndStays(Fault::kNonFiniteFeature, 1500);
  ExpectResetWorks();
}

TEST_F(FaultTest, DeadlinesMissed) {
  Tick([](ServoInputs& inputs) { inputs.missed_ticks = 1; });
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack) << "one miss is held by rule";
  Tick([this](ServoInputs& inputs) { inputs.missed_ticks = config_.safety.missed_ticks; });
  ExpectStopsAndStays(Fault::kDeadlineMissed, 1500);
  ExpectResetWorks();
}

TEST_F(FaultTest, JointOutsideItsRange) {
  Tick([](ServoInputs& inputs) { inputs.arm.q[5] = 3.76; });
  EXPECT_EQ(outputs_.record.fault_joint, 5);
  ExpectStopsAndStays(Fault::kJointPosition, 1500);
}

TEST_F(FaultTest, JointTooFast) {
  Tick([](ServoInputs& inputs) { inputs.arm.dq[2] = -2.2; });
  EXPECT_EQ(outputs_.record.fault_joint, 2);
  ExpectStopsAndStays(Fault::kJointVelocity, 1500);
}

// What jams the arm pushes it.
TEST_F(FaultTest, SomethingHoldsTheArm) {
  arm_->Jam();
  int ticks = 0;
  while (outputs_.record.mode != Mode::kFault && ticks++ < 3000) {
    Tick();
  }
  std::cout << "found after " << ticks << " ms\n";
  EXPECT_GE(outputs_.record.fault_joint, 0);
  ExpectStopsAndStays(Fault::kContact, 150);
}

TEST_F(FaultTest, AFloatingArmMayBePushed) {
  ServoConfig config = test::PandaConfig();
  config.safety.contact_torque_fraction = 0.05;
  camera_on_ = false;
  for (const MotionLawKind law : {MotionLawKind::kFloat, MotionLawKind::kComputedTorque}) {
    config.motion_law.kind = law;
    Start(config);
    Run(100);
    ASSERT_EQ(outputs_.record.mode, Mode::kHold);
    for (int i = 0; i < 80; ++i) {
      arm_->SetVelocity(arm_->dq() + 0.02 * model::VecN::Unit(7, 0));  // some 10 Nm
      Tick();
    }
    EXPECT_STREQ(hal::Name(outputs_.record.fault), law == MotionLawKind::kFloat ? "none" : "contact");
  }
}

// Without that observer it is seen later, by its error.
TEST_F(FaultTest, ArmDoesNotFollow) {
  ServoConfig config = test::PandaConfig();
  config.safety.contact_torque_fraction = 1e3;
  Start(config);
  Run(500);
  arm_->Jam();
  int ticks = 0;
  while (outputs_.record.mode != Mode::kFault && ticks++ < 3000) {
    Tick();
  }
  std::cout << "found after " << ticks << " ms\n";
  EXPECT_GE(outputs_.record.fault_joint, 0);
  ExpectStopsAndStays(Fault::kNotFollowing, 150);  // the torque had grown, and goes at its own rate
}

// Whatever is thrown at it, in any order: the command stays finite, within range and within rate.
TEST_F(ServoTaskTest, NothingOnTheInputsBreaksTheTorqueLimits) {
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
          in_force[joint] = value;  // a lie that cannot be known for one
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
}  // namespace fovea::servo
