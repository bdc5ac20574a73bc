// SPDX-License-Identifier: Apache-2.0
// The eye's beliefs from synthetic runs with known errors.
#include "firmware/host/beliefs/eye_estimate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/host/beliefs/synthetic_run.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::beliefs {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

test::SyntheticTruth Draw(unsigned seed) {
  test::RandomStates random(seed);
  test::SyntheticTruth truth;
  truth.late = random.Uniform(-0.02, 0.02);
  truth.shift = random.Vector(0.005);
  truth.turn = random.Vector(0.02);
  truth.focal = random.Uniform(-0.02, 0.02);
  truth.size = random.Uniform(-0.01, 0.01);
  return truth;
}

EyeEstimate RunOnce(const config::ServoConfig& config, const test::JointPath& path,
                    const test::SyntheticTruth& truth, double duration_s, unsigned seed) {
  EyeEstimator estimator(config);
  test::MakeRun(config, path, {model::Mat3::Identity(), test::BallPlace()}, truth, {}, duration_s, seed,
                [&](const hal::TickRecord& record) { estimator.Add(record); });
  return estimator.Estimate();
}

const Belief& Find(const EyeEstimate& estimate, const std::string& name) {
  for (const Belief& belief : estimate.beliefs) {
    if (belief.name == name) {
      return belief;
    }
  }
  throw std::logic_error("there is no belief " + name);
}

struct Expected {
  const char* name;
  double sigma_most;  // goals of the estimates, in the belief's unit
  double (*of)(const test::SyntheticTruth& truth);
};
constexpr std::array<Expected, 8> kExpected{{
    {"latency", 2.0, [](const test::SyntheticTruth& t) { return 1e3 * t.late; }},
    {"mount turn about the camera's x axis", 0.3,
     [](const test::SyntheticTruth& t) { return kDegPerRad * t.turn.x(); }},
    {"mount turn about the camera's y axis", 0.3,
     [](const test::SyntheticTruth& t) { return kDegPerRad * t.turn.y(); }},
    {"mount turn about the camera's z axis", 0.3,
     [](const test::SyntheticTruth& t) { return kDegPerRad * t.turn.z(); }},
    {"mount shift along the camera's x axis", 0.005,
     [](const test::SyntheticTruth& t) { return t.shift.x(); }},
    {"mount shift along the camera's y axis", 0.005,
     [](const test::SyntheticTruth& t) { return t.shift.y(); }},
    {"mount shift along the camera's z axis", 0.005,
     [](const test::SyntheticTruth& t) { return t.shift.z(); }},
    {"focal length", 0.5, [](const test::SyntheticTruth& t) { return 100.0 * t.focal; }},
}};

TEST(EyeEstimateTest, LookingAroundTellsEverything) {
  constexpr unsigned kRuns = 300;
  const config::ServoConfig config = test::PandaConfig();
  std::array<int, kExpected.size()> known{};
  std::array<int, kExpected.size()> within{};
  std::array<double, kExpected.size()> sigma{};
  for (unsigned run = 0; run < kRuns; ++run) {
    const test::SyntheticTruth truth = Draw(run);
    const EyeEstimate estimate = RunOnce(config, test::LookAround(), truth, 7.0, run);
    for (std::size_t i = 0; i < kExpected.size(); ++i) {
      const Belief& belief = Find(estimate, kExpected[i].name);
      known[i] += belief.IsKnown() ? 1 : 0;
      within[i] += std::fabs(belief.difference - kExpected[i].of(truth)) <= 2.0 * belief.sigma ? 1 : 0;
      sigma[i] = std::max(sigma[i], belief.sigma);
    }
  }
  for (std::size_t i = 0; i < kExpected.size(); ++i) {
    fmt::print("{:<20} known in {:5.1f} %, within 2 sigma in {:5.1f} %, sigma at most {:.4f}\n",
               kExpected[i].name, 100.0 * known[i] / kRuns, 100.0 * within[i] / kRuns, sigma[i]);
    EXPECT_EQ(known[i], kRuns) << kExpected[i].name;
    EXPECT_GE(within[i], 0.90 * kRuns) << kExpected[i].name;
    EXPECT_LE(within[i], 0.99 * kRuns) << kExpected[i].name;
    EXPECT_LE(sigma[i], kExpected[i].sigma_most) << kExpected[i].name;
  }
}

// Without a turn of the camera, its place on the hand cannot be told from the target's; without a way in
// depth, the turn about the way is part of the target's place, too.
TEST(EyeEstimateTest, ALineLeavesThePlaceOfTheMountUnknown) {
  const config::ServoConfig config = test::PandaConfig();
  constexpr double kSeconds = 5.0;
  for (unsigned run = 0; run < 12; ++run) {
    test::RandomStates random(run);
    const model::Vec3 direction = random.Vector(1.0).normalized();
    const EyeEstimate estimate =
        RunOnce(config, test::AlongALine(config, direction, 0.06, 2.0, kSeconds), Draw(run), kSeconds, run);
    EXPECT_GT(estimate.views, 50);
    for (const char* axis : {"x", "y", "z"}) {
      EXPECT_FALSE(Find(estimate, fmt::format("mount shift along the camera's {} axis", axis)).IsKnown())
          << "run " << run;
    }
    const Belief& late = Find(estimate, "latency");
    fmt::print("run {}: latency +- {:.2f} ms, shift +- {:.3f} m\n", run, late.sigma,
               Find(estimate, "mount shift along the camera's x axis").sigma);
    EXPECT_TRUE(late.IsKnown()) << "it reverses: the latency shows";
  }
}

TEST(EyeEstimateTest, AnArmThatStandsTellsNothing) {
  const config::ServoConfig config = test::PandaConfig();
  test::Waves standing = test::LookAround();
  standing.amplitude.setZero();
  const EyeEstimate estimate = RunOnce(config, standing, Draw(1), 2.0, 1);
  ASSERT_FALSE(estimate.beliefs.empty());
  for (const Belief& belief : estimate.beliefs) {
    EXPECT_FALSE(belief.IsKnown()) << belief.name;
  }
}

// All views of the motion are then older than what the track keeps.
TEST(EyeEstimateTest, AMinuteOfRestLeavesNothingToKnow) {
  const test::Waves waves = test::LookAround();
  const auto then_rests = [&waves](double t_s) {
    constexpr double kRestFrom = 3.0;
    test::JointsNow now = waves(std::min(t_s, kRestFrom));
    if (t_s > kRestFrom) {
      now.dq.setZero();
      now.ddq.setZero();
    }
    return now;
  };
  const EyeEstimate estimate = RunOnce(test::PandaConfig(), then_rests, Draw(1), 66.0, 1);
  for (const Belief& belief : estimate.beliefs) {
    EXPECT_FALSE(belief.IsKnown()) << belief.name;
  }
}

// The rows' times would pass for a latency.
TEST(EyeEstimateTest, ARollingShutterIsNotJudged) {
  config::ServoConfig config = test::PandaConfig();
  config.predict.row_time = 1e-3;
  EXPECT_EQ(RunOnce(config, test::LookAround(), Draw(1), 7.0, 1).views, 0);
}

}  // namespace
}  // namespace fovea::beliefs
