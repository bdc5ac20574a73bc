// SPDX-License-Identifier: Apache-2.0
// A request to change a key is refused for each reason, or the key follows the smooth step to its new value.
#include "firmware/core/task/tune.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>

#include "firmware/core/control/visual_law.hpp"

namespace fovea::task {
namespace {

using hal::TuningResult;

enum Key : std::int32_t {
  kLambda = 0,
  kLambdaNear = 1,
  kPosture = 4,
  kStale = 11,
  kCoast = 12,
  kStampOffset = config::kStampOffsetKey,
  kLoadOffset = config::kLoadOffsetKey
};

class TuneTest : public testing::Test {
 protected:
  const hal::TuningNote& Ask(std::int32_t key, double value) {
    Tune({key, value}, config_, state_);
    return state_.note;
  }
  void Pass(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      Tune({}, config_, state_);
    }
  }
  // 3 x^2 - 2 x^3, `ticks` after the request.
  static double Step(int ticks) {
    const double x = ticks / 250.0;
    return 3.0 * x * x - 2.0 * x * x * x;
  }

  config::ServoConfig config_;
  TuningState state_;
};

TEST_F(TuneTest, EachBadRequestIsRefusedWithItsReason) {
  struct Case {
    std::int32_t key;
    double value;
    TuningResult result;
  };
  const double infinity = std::numeric_limits<double>::infinity();
  const config::ServoConfig before = config_;
  for (const Case& bad : {Case{kLambda, std::nan(""), TuningResult::kNotFinite},
                          Case{kLambda, infinity, TuningResult::kNotFinite},
                          Case{kLambda, std::nextafter(20.0, 21.0), TuningResult::kOutOfRange},
                          Case{kLambda, -1e-300, TuningResult::kOutOfRange},
                          Case{kStale, std::nextafter(0.6, 1.0), TuningResult::kInconsistent},
                          Case{kCoast, 0.14, TuningResult::kInconsistent},
                          Case{15, 1.0, TuningResult::kUnknownKey}, Case{-7, 1.0, TuningResult::kUnknownKey},
                          Case{std::numeric_limits<std::int32_t>::max(), 1.0, TuningResult::kUnknownKey}}) {
    const hal::TuningNote note = Ask(bad.key, bad.value);
    EXPECT_EQ(note.result, bad.result)
        << hal::Name(note.result) << ", key " << bad.key << " to " << bad.value;
    EXPECT_EQ(note.key, bad.key);
    EXPECT_EQ(std::memcmp(&note.asked, &bad.value, sizeof(double)), 0);
    EXPECT_TRUE(state_.active) << "the refusal is part of the state";
    Pass();
    EXPECT_EQ(state_.note.result, TuningResult::kNone);
    EXPECT_FALSE(state_.active);
  }
  EXPECT_EQ(config_.law.lambda, before.law.lambda);
  EXPECT_EQ(config_.predict.stale_s, before.predict.stale_s);
  EXPECT_EQ(config_.predict.coast_s, before.predict.coast_s);
  EXPECT_EQ(Ask(kStale, 0.6).result, TuningResult::kTaken) << "equal to servo.coast_s";
  EXPECT_EQ(Ask(kLambda, 20.0).result, TuningResult::kTaken) << "the end of the range";
}

TEST_F(TuneTest, KeyFollowsTheSmoothStep) {
  const hal::TuningNote note = Ask(kLambda, 4.0);
  EXPECT_EQ(note.result, TuningResult::kTaken);
  EXPECT_EQ(note.before, 2.0);
  double worst = 0.0;
  for (int ticks = 1; ticks < 250; ++ticks) {
    worst = std::max(worst, std::fabs(config_.law.lambda - (2.0 + 2.0 * Step(ticks))));
    EXPECT_TRUE(state_.active);
    Pass();
  }
  EXPECT_LT(worst, 1e-14);
  EXPECT_EQ(config_.law.lambda, 4.0) << "after 250 ticks, to the last bit";
  EXPECT_TRUE(state_.active);
  Pass();
  EXPECT_FALSE(state_.active);
  EXPECT_EQ(config_.law.lambda, 4.0);
  EXPECT_EQ(config_.law.posture_gain, config::LawConfig{}.posture_gain) << "no other key moves";
}

TEST_F(TuneTest, LaterRequestGoesOnFromThePresentValue) {
  Ask(kLambda, 4.0);
  Pass(99);
  const double present = config_.law.lambda;
  EXPECT_NEAR(present, 2.0 + 2.0 * Step(100), 1e-14);
  EXPECT_EQ(Ask(kLambda, 1.0).before, present);
  EXPECT_NEAR(config_.law.lambda, present + (1.0 - present) * Step(1), 1e-14);
  Pass(249);
  EXPECT_EQ(config_.law.lambda, 1.0);
}

// A slider sends the value at which it stands more than once.
TEST_F(TuneTest, RepeatedRequestDoesNotDelayTheKey) {
  for (int ticks = 1; ticks <= 250; ++ticks) {
    EXPECT_EQ(Ask(kLambda, 4.0).result, TuningResult::kTaken);
  }
  EXPECT_EQ(config_.law.lambda, 4.0);
  Ask(kLambda, 4.0);
  EXPECT_EQ(config_.law.lambda, 4.0);
}

TEST_F(TuneTest, SeveralKeysMoveAtOnce) {
  Ask(kLambda, 4.0);
  Ask(kPosture, 0.0);
  Pass(100);
  EXPECT_NEAR(config_.law.lambda, 2.0 + 2.0 * Step(102), 1e-14);
  EXPECT_NEAR(config_.law.posture_gain, 0.6 - 0.6 * Step(101), 1e-14);
}

// 0 in servo.lambda_near switches to servo.lambda. The gain near the goal does not jump on the way there or
// back.
TEST_F(TuneTest, GainIsSteadyWhileTheGainNearTheGoalIsSwitched) {
  double least = 1e9;
  double most_step = 0.0;
  double last = control::GainAt(config_.law, 0.0);
  for (const double value : {5.0, 0.0, 3.0}) {
    for (int ticks = 0; ticks < 300; ++ticks) {
      if (ticks == 0) {
        Ask(kLambdaNear, value);
      } else if (ticks == 100) {
        Ask(kLambda, 1.0 + value);  // both at once
      } else {
        Pass();
      }
      const double gain = control::GainAt(config_.law, 0.0);
      most_step = std::max(most_step, std::fabs(gain - last));
      least = std::min(least, gain);
      last = gain;
    }
    EXPECT_EQ(config_.law.lambda_near, value);
    Pass(100);
    last = control::GainAt(config_.law, 0.0);
  }
  std::printf("the gain is at least %.3f and moves by at most %.4f per tick\n", least, most_step);
  EXPECT_GT(least, 0.9);
  EXPECT_LT(most_step, 0.06) << "1.5 times (6 - 1) / 250 from each key";
}

// A goal to which another key still moves counts, and so does its present value.
TEST_F(TuneTest, ChecksAcrossKeysHoldAllTheWay) {
  Ask(kCoast, 2.0);  // from 0.6
  Pass(50);
  EXPECT_EQ(Ask(kStale, 1.5).result, TuningResult::kInconsistent) << "servo.coast_s is not there yet";
  Pass(250);
  EXPECT_EQ(Ask(kStale, 1.5).result, TuningResult::kTaken);
  EXPECT_EQ(Ask(kCoast, 1.0).result, TuningResult::kInconsistent) << "servo.stale_s moves above it";
}

TEST_F(TuneTest, RandomRequestsKeepTheChecksAcrossKeys) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> seconds(0.0, 1.5);
  int taken = 0;
  int refused = 0;
  for (int tick = 0; tick < 100'000; ++tick) {
    if (engine() % 40 == 0) {
      const auto result = Ask(engine() % 2 == 0 ? kStale : kCoast, seconds(engine)).result;
      (result == TuningResult::kTaken ? taken : refused) += 1;
    } else {
      Pass();
    }
    ASSERT_TRUE(config::IsStaleBeforeLost(config_.predict)) << tick;
  }
  std::printf("%d requests taken, %d refused\n", taken, refused);
  EXPECT_GT(taken, 500);
  EXPECT_GT(refused, 500);
}

// What servo.learn asks for is bounded like any other request.
TEST_F(TuneTest, LearntOffsetsAreBounded) {
  config_.load.mass = 0.25;
  EXPECT_EQ(Ask(kStampOffset, std::nextafter(0.05, 1.0)).result, TuningResult::kOutOfRange);
  EXPECT_EQ(Ask(kStampOffset, -0.051).result, TuningResult::kOutOfRange);
  EXPECT_EQ(Ask(kStampOffset, std::nan("")).result, TuningResult::kNotFinite);
  EXPECT_EQ(Ask(kLoadOffset, 1.01).result, TuningResult::kOutOfRange);
  EXPECT_EQ(Ask(kLoadOffset, std::nan("")).result, TuningResult::kNotFinite);
  EXPECT_EQ(Ask(kLoadOffset, -0.26).result, TuningResult::kInconsistent)
      << "no load weighs less than nothing";
  EXPECT_EQ(config_.predict.stamp_offset, 0.0);
  EXPECT_EQ(config_.load.offset, 0.0);
  EXPECT_EQ(Ask(kLoadOffset, -0.25).result, TuningResult::kTaken);
  EXPECT_EQ(Ask(kStampOffset, 0.05).result, TuningResult::kTaken);
  double last = 0.0;
  for (int ticks = 2; ticks <= 250; ++ticks) {
    Pass();
    EXPECT_GT(config_.predict.stamp_offset, last);
    EXPECT_LT(config_.predict.stamp_offset - last, 1.6 * 0.05 / 250.0);
    last = config_.predict.stamp_offset;
  }
  EXPECT_EQ(config_.predict.stamp_offset, 0.05);
  EXPECT_EQ(config_.load.offset, -0.25);
}

TEST_F(TuneTest, StateAloneRestoresTheKeys) {
  Ask(kLambda, 4.0);
  Pass(30);
  Ask(kLambdaNear, 6.0);
  Pass(30);
  config::ServoConfig restored;
  ApplyTunings(state_, restored);
  TuningState there = state_;
  for (int ticks = 0; ticks < 300; ++ticks) {
    ASSERT_EQ(restored.law.lambda, config_.law.lambda) << ticks;
    ASSERT_EQ(restored.law.lambda_near, config_.law.lambda_near) << ticks;
    Pass();
    Tune({}, restored, there);
  }
  EXPECT_EQ(restored.law.lambda_near, 6.0);
}

}  // namespace
}  // namespace fovea::task
