// SPDX-License-Identifier: Apache-2.0
// Keys that change in motion, in closed loop with an ideal arm.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>

#include "firmware/core/guard/following.hpp"
#include "tests/core/task/task_on_ideal_arm.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::task {
namespace {

class TunedLoopTest : public ServoTaskTest {
 protected:
  void TrackFor(int ticks) {
    while (Tick().mode != hal::Mode::kTrack) {
    }
    Run(ticks);
  }
  // The error's decay rate over the next `ticks` [1/s].
  double Rate(int ticks) {
    const double before = Error();
    Run(ticks);
    return std::log(before / Error()) / (1e-3 * ticks);
  }
};

// lambda 2 -> 4 in the middle of an approach halves the time constant of the rest.
TEST_F(TunedLoopTest, TwiceTheGainHalvesTheTimeConstant) {
  TrackFor(600);  // past the smooth start
  const double before = Rate(300);
  Tick([](ServoInputs& inputs) { inputs.tuning = {0, 4.0}; });
  EXPECT_EQ(outputs_.record.tuning.result, hal::TuningResult::kTaken);
  Run(450);  // the ramp, and the settling of the joints' own loop
  EXPECT_EQ(outputs_.record.tuning.result, hal::TuningResult::kNone);
  const double after = Rate(300);
  std::cout << "time constant " << 1e3 / before << " ms, then " << 1e3 / after << " ms\n";
  EXPECT_NEAR(before, 2.0, 0.1);
  EXPECT_NEAR(after / before, 2.0, 0.1);
}

// The torque takes no step when a gain changes: it moves less in one tick than it does when tracking begins,
// which is blended in, too.
TEST_F(TunedLoopTest, TorqueStaysSmoothWhenTheGainChanges) {
  constexpr int kChange = 400;
  const auto most_step = [this](double lambda) {
    Start(test::PandaConfig());
    ticks_ = 0;
    pending_.clear();
    TrackFor(1);
    std::array<double, 2> most{};  // before and after the change
    hal::TickRecord last = outputs_.record;
    for (int k = 0; k < 700; ++k) {
      Tick([&](ServoInputs& inputs) {
        if (k == kChange) {
          inputs.tuning = {0, lambda};
        }
      });
      double& part = most[k < kChange ? 0 : 1];
      for (std::size_t i = 0; i < 7; ++i) {
        part = std::max(part, std::fabs(outputs_.record.command.tau_cmd[i] - last.command.tau_cmd[i]));
      }
      last = outputs_.record;
    }
    return most;
  };
  const auto [start, without] = most_step(2.0);
  const double with = most_step(4.0)[1];
  std::cout << "largest step of a torque per tick: at the start " << start << " Nm, later " << without
            << " Nm, with the change " << with << " Nm\n";
  EXPECT_GT(with, without) << "there is a change";
  EXPECT_LT(with, start);
}

// A learnt load comes into the torque without a step, and the standing arm then carries its weight.
TEST_F(TunedLoopTest, LoadComesInWithoutAStep) {
  config::ServoConfig config = test::PandaConfig();
  config.load.p_ECom = {0.05, 0.0, 0.02};
  Start(config);
  camera_on_ = false;
  Run(200);
  hal::TickRecord last = outputs_.record;
  ASSERT_EQ(last.mode, hal::Mode::kHold);
  double most_step = 0.0;
  for (int k = 0; k < 300; ++k) {
    const hal::TickRecord& r = Tick([&](ServoInputs& inputs) {
      if (k == 0) {
        inputs.tuning = {config::kLoadOffsetKey, 0.5};
      }
    });
    for (std::size_t i = 0; i < 7; ++i) {
      most_step = std::max(most_step, std::fabs(r.command.tau_cmd[i] - last.command.tau_cmd[i]));
    }
    last = r;
  }
  const model::VecN weight = model::HoldingTorque(config.arm, task_.state().poses, {0.5, config.load.p_ECom});
  std::cout << "largest step " << most_step << " Nm per tick of " << weight.lpNorm<Eigen::Infinity>()
            << " Nm\n";
  EXPECT_GT(weight.lpNorm<Eigen::Infinity>(), 1.0);
  EXPECT_LT(most_step, 0.02 * weight.lpNorm<Eigen::Infinity>()) << "of one step: 1.5 / 250, and the law";
}

// Whatever is requested, the servo keeps its limits: torque and its rate, the reference's speed and
// acceleration, the workspace; and it raises no fault.
TEST_F(TunedLoopTest, RandomRequestsBreakNoLimit) {
  std::mt19937 engine(17);
  const auto draw = [&engine](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  int taken = 0;
  int refused = 0;
  double most_torque = 0.0;
  double most_speed = 0.0;
  for (int run = 0; run < test::Repetitions(20); ++run) {
    config::ServoConfig config = test::PandaConfig();
    Start(config);
    ticks_ = 0;
    pending_.clear();
    for (int k = 0; k < 3000; ++k) {
      camera_on_ = k % 900 < 700;
      if (k % 700 == 0) {
        target_.y() += draw(-0.05, 0.05);  // a new error to act on
      }
      const hal::TickRecord& r = Tick([&](ServoInputs& inputs) {
        if (engine() % 30 == 0) {
          const auto key = static_cast<std::int32_t>(engine() % 15) - 1;
          double value = 0.0;
          config::EachTunable(config, [&](const config::Field& field, double, double min, double max) {
            if (field.in_motion == key) {
              value = engine() % 2 == 0 ? draw(min, max)
                                        : std::exp(draw(std::log(std::max(min, 1e-5 * max)), std::log(max)));
              value = engine() % 8 == 0 ? min : engine() % 8 == 0 ? max : value;
            }
          });
          value = engine() % 10 == 0 ? std::nan("") : engine() % 10 == 0 ? 1e9 : value;
          inputs.tuning = {key, value};
        }
        inputs.request = k % 900 == 800 ? Request::kTrack : Request::kNone;
      });
      taken += r.tuning.result == hal::TuningResult::kTaken ? 1 : 0;
      refused += r.tuning.result > hal::TuningResult::kTaken ? 1 : 0;
      ASSERT_EQ(r.fault, hal::Fault::kNone) << hal::Name(r.fault) << ", run " << run << ", tick " << k;
      for (std::size_t i = 0; i < 7; ++i) {
        const model::Joint& joint = config.arm.joints[i];
        ASSERT_TRUE(std::isfinite(r.command.tau_cmd[i]));
        most_torque = std::max(most_torque, std::fabs(r.command.tau_cmd[i]) / joint.tau_max);
        most_speed = std::max(most_speed,
                              std::fabs(r.dq_cmd[i]) / (config.guard.joint_velocity_fraction * joint.dq_max));
        ASSERT_LE(std::fabs(r.ddq_cmd[i]),
                  config.guard.joint_acceleration_fraction * joint.ddq_max * (1.0 + 1e-9));
        ASSERT_GE(r.arm.q[i], joint.q_min);
        ASSERT_LE(r.arm.q[i], joint.q_max);
      }
      ASSERT_LE(task_.state().poses.X_BE.p.norm(), config.guard.workspace_radius);
      ASSERT_LT(guard::JointThatDoesNotFollow(config.safety, task_.state().reference.q, task_.state().q), 0);
    }
  }
  std::cout << taken << " requests taken, " << refused << " refused; torque at most " << most_torque
            << " of its range, speed " << most_speed << " of its limit\n";
  EXPECT_LE(most_torque, 1.0);
  EXPECT_LE(most_speed, 1.0 + 1e-4) << "braking at full jerk ends slightly later";
  EXPECT_GT(taken, test::Repetitions(20) * 40);
  EXPECT_GT(refused, test::Repetitions(20) * 10);
}

// The planner beside the tick knows the gains of the begin: with another one, a predictive law goes on by its
// own matrix.
TEST_F(TunedLoopTest, PredictiveLawAsksForNoHorizonWithAnotherGain) {
  config::ServoConfig config = test::PandaConfig();
  config.law.law = config::Law::kPredictive;
  Start(config);
  target_ = X_BC() * model::Vec3(0.03, -0.02, 0.43);
  TrackFor(600);
  const int asked = outputs_.record.way.plans_asked;
  EXPECT_GT(asked, 0);
  Run(500);
  EXPECT_GT(outputs_.record.way.plans_asked, asked);
  Tick([](ServoInputs& inputs) { inputs.tuning = {0, 4.0}; });
  EXPECT_EQ(outputs_.record.tuning.result, hal::TuningResult::kTaken);
  const int last = outputs_.record.way.plans_asked;
  Run(1000);
  EXPECT_EQ(outputs_.record.way.plans_asked, last);
  EXPECT_EQ(outputs_.record.mode, hal::Mode::kTrack);
}

}  // namespace
}  // namespace fovea::task
