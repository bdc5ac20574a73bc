// SPDX-License-Identifier: Apache-2.0
// Leaks and drift are detected; scatter is not reported.
#include "tests/soak/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fovea::soak {
namespace {

constexpr double kKiB = 1024.0;
constexpr double kMost = 256.0 * kKiB;

// Samples of a day: `growth(share)` [bytes] on top of 50 MB, with a scatter of 20 KiB.
template <class Grow>
std::vector<MemorySample> Day(const Grow& growth) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> scatter(0.0, 20.0 * kKiB);
  std::vector<MemorySample> samples;
  samples.reserve(201);
  for (int i = 0; i <= 200; ++i) {
    const double share = i / 200.0;
    samples.push_back({86'400.0 * share, 5e7 + scatter(engine) + growth(share)});
  }
  return samples;
}

TEST(MemoryJudgeTest, DetectsALeakOfAHundredthOfAByteATick) {
  const Growth growth = JudgeMemory(Day([](double share) { return 0.01 * 86.4e6 * share; }), kMost);
  std::cout << "grew by " << growth.bytes / kKiB << " KiB\n";
  EXPECT_TRUE(growth.leaks);
  EXPECT_NEAR(growth.bytes, 0.9 * 0.01 * 86.4e6, 20.0 * kKiB);
}

TEST(MemoryJudgeTest, WarmUpAndScatterAreNoLeak) {
  const auto warm_up = [](double share) { return 4e6 * std::min(1.0, share / 0.05); };
  const Growth growth = JudgeMemory(Day(warm_up), kMost);
  std::cout << "grew by " << growth.bytes / kKiB << " KiB\n";
  EXPECT_FALSE(growth.leaks);
  EXPECT_LT(std::fabs(growth.bytes), 20.0 * kKiB);
  EXPECT_FALSE(JudgeMemory({}, kMost).leaks);
}

// Ten tenths of `each` values with mean 1 and deviation 0.3; the mean moves by `by` up to the last tenth.
Tenths Ten(int each, double by) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> scatter(1.0, 0.3);
  Tenths tenths;
  for (int tenth = 0; tenth < 10; ++tenth) {
    for (int i = 0; i < each; ++i) {
      tenths[static_cast<std::size_t>(tenth)].Add(scatter(engine) + by * tenth / 9.0);
    }
  }
  return tenths;
}

TEST(DriftJudgeTest, DetectsADriftingFigureButNotAScatteringOne) {
  const Drift moves = JudgeDrift(Ten(300, 0.2), 0.02);
  const Drift scatters = JudgeDrift(Ten(300, 0.0), 0.02);
  std::cout << "moves: " << moves.sigmas << " sigma, scatters: " << scatters.sigmas << " sigma\n";
  EXPECT_TRUE(moves.drifts);
  EXPECT_FALSE(scatters.drifts);
}

TEST(DriftJudgeTest, SignificantButTinyShiftIsNoDrift) {
  EXPECT_TRUE(JudgeDrift(Ten(100'000, 0.01), 0.0).drifts);
  EXPECT_FALSE(JudgeDrift(Ten(100'000, 0.01), 0.02).drifts);
}

TEST(DriftJudgeTest, NonFiniteFigureCountsAsDrift) {
  Tenths tenths = Ten(20, 0.0);
  tenths.back().Add(std::nan(""));
  EXPECT_TRUE(JudgeDrift(tenths, 0.02).drifts);
}

TEST(DriftJudgeTest, TooFewValuesShowNoDrift) { EXPECT_FALSE(JudgeDrift(Ten(7, 100.0), 0.02).drifts); }

TEST(SpreadTest, HasMeanAndDeviation) {
  Spread spread;
  for (const double x : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) {
    spread.Add(x);
  }
  EXPECT_DOUBLE_EQ(spread.mean, 5.0);
  EXPECT_NEAR(spread.Sigma(), std::sqrt(32.0 / 7.0), 1e-12);
}

}  // namespace
}  // namespace fovea::soak
