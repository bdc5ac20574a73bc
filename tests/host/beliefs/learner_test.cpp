// SPDX-License-Identifier: Apache-2.0
// What is found out becomes a bounded request, or none.
#include "firmware/host/beliefs/learner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/panda.hpp"

namespace fovea::beliefs {
namespace {

class LearnerTest : public testing::Test {
 protected:
  static config::ServoConfig Config() {
    config::ServoConfig config = test::PandaConfig();
    config.load.mass = 0.25;
    return config;
  }
  static Findings Found(double late_ms, double sigma_ms, double load = 0.0, double sigma_kg = 0.01) {
    Findings findings;
    findings.beliefs.push_back({"latency", "camera.latency_ms", "ms", late_ms, sigma_ms, 5.0, 1.0});
    findings.beliefs.push_back({"load", "arm.load_mass", "kg", load, sigma_kg, 0.1, 0.02});
    return findings;
  }
  static void Answer(Learner& learner, const config::Tuning& request, hal::TuningResult result) {
    hal::TickRecord record;
    record.stamp_ns = 750'000'000;
    record.tuning = {result, request.key, 0.0, request.value};
    learner.Note(record);
  }
  static std::vector<config::Tuning> Decide(const Findings& findings, Learns learns = {true, true}) {
    return Learner(Config(), learns).Decide(findings);
  }
};

TEST_F(LearnerTest, AsksForWhatIsSurelyWrong) {
  const std::vector<config::Tuning> requests = Decide(Found(18.0, 0.5, 0.3, 0.01));
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[0].key, config::kStampOffsetKey);
  EXPECT_NEAR(requests[0].value, 0.018 * (1.0 - 1.5 * 1.5 / (18.0 * 18.0)), 1e-15);
  EXPECT_EQ(requests[1].key, config::kLoadOffsetKey);
  EXPECT_NEAR(requests[1].value, 0.3 * (1.0 - 0.03 * 0.03 / (0.3 * 0.3)), 1e-15);
}

TEST_F(LearnerTest, AsksForNothingWhileTheServoHasAFaultOrDoubtsItsEye) {
  const Findings findings = Found(18.0, 0.5, 0.3, 0.01);
  Learner learner(Config(), {true, true});
  hal::TickRecord record;
  const auto asks = [&] {
    learner.Note(record);
    return !learner.Decide(findings).empty();
  };
  record.mode = hal::Mode::kTrack;
  EXPECT_TRUE(asks());
  record.mode = hal::Mode::kFault;
  EXPECT_FALSE(asks());
  record.mode = hal::Mode::kHold;
  record.hold_reason = hal::HoldReason::kEyeDoubted;
  EXPECT_FALSE(asks());
  record.hold_reason = hal::HoldReason::kNotAsked;
  EXPECT_TRUE(asks());
  record.command.engage_brakes = true;
  EXPECT_FALSE(asks());
}

TEST_F(LearnerTest, AsksOnlyForWhatItIsToldTo) {
  const Findings findings = Found(18.0, 0.5, 0.3, 0.01);
  EXPECT_TRUE(Decide(findings, {false, false}).empty());
  ASSERT_EQ(Decide(findings, {true, false}).size(), 1U);
  EXPECT_EQ(Decide(findings, {true, false})[0].key, config::kStampOffsetKey);
  ASSERT_EQ(Decide(findings, {false, true}).size(), 1U);
  EXPECT_EQ(Decide(findings, {false, true})[0].key, config::kLoadOffsetKey);
}

TEST_F(LearnerTest, LeavesWhatIsUnknownUnsureOrSmall) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::nan("");
  EXPECT_TRUE(Decide(Found(18.0, 5.1)).empty()) << "unknown";
  EXPECT_TRUE(Decide(Found(18.0, infinity)).empty());
  EXPECT_TRUE(Decide(Found(8.9, 3.0)).empty()) << "less than three standard deviations";
  EXPECT_TRUE(Decide(Found(0.9, 0.01)).empty()) << "does not matter";
  EXPECT_TRUE(Decide(Found(nan, 0.5, nan)).empty());
  EXPECT_TRUE(Decide(Found(18.0, nan, 0.3, nan)).empty());
  EXPECT_TRUE(Decide({}).empty());
}

// A finding that barely counts hardly moves the key: at three standard deviations the step begins at 0.
TEST_F(LearnerTest, StepIsShortWhereTheFindingIsUnsure) {
  ASSERT_EQ(Decide(Found(3.01, 1.0)).size(), 1U);
  const double barely = Decide(Found(3.01, 1.0))[0].value;
  EXPECT_GT(barely, 0.0);
  EXPECT_LT(barely, 0.0001);
  EXPECT_GT(Decide(Found(30.0, 1.0))[0].value, 0.0296);
}

TEST_F(LearnerTest, StaysWithinTheBounds) {
  EXPECT_EQ(Decide(Found(400.0, 1.0))[0].value, 0.05);
  EXPECT_EQ(Decide(Found(-400.0, 1.0))[0].value, -0.05);
  EXPECT_EQ(Decide(Found(0.0, 1.0, 7.0))[0].value, 1.0);
  EXPECT_EQ(Decide(Found(0.0, 1.0, -7.0))[0].value, -0.25) << "no load weighs less than nothing";
}

TEST_F(LearnerTest, DoesNotAskAgainForWhatIsInForce) {
  Learner learner(Config(), {true, true});
  const std::vector<config::Tuning> first = learner.Decide(Found(18.0, 0.2));
  ASSERT_EQ(first.size(), 1U);
  Answer(learner, first[0], hal::TuningResult::kTaken);
  EXPECT_TRUE(learner.Decide(Found(18.3, 0.2)).empty());
  const std::vector<config::Tuning> next = learner.Decide(Found(25.0, 0.2));
  ASSERT_EQ(next.size(), 1U);
  EXPECT_NEAR(next[0].value, 0.025, 1e-4);
  ASSERT_EQ(learner.corrections().size(), 1U);
  const Correction& correction = learner.corrections()[0];
  EXPECT_EQ(correction.key, "servo.stamp_offset");
  EXPECT_EQ(correction.to, first[0].value);
  EXPECT_EQ(correction.text, "latency: servo.stamp_offset = 0.01798 s since 0.750 s, 0 before");
}

// What the servo refused, or an operator set, is no correction of the learner; but it starts from there.
TEST_F(LearnerTest, TellsItsOwnRequestsFromOthers) {
  Learner learner(Config(), {true, true});
  const std::vector<config::Tuning> first = learner.Decide(Found(18.0, 0.2));
  Answer(learner, first[0], hal::TuningResult::kOutOfRange);
  EXPECT_EQ(learner.Decide(Found(18.0, 0.2)).size(), 1U) << "not in force";
  Answer(learner, {config::kStampOffsetKey, 0.0181}, hal::TuningResult::kTaken);
  EXPECT_TRUE(learner.Decide(Found(18.0, 0.2)).empty());
  EXPECT_TRUE(learner.corrections().empty());
}

}  // namespace
}  // namespace fovea::beliefs
