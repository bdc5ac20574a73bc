// SPDX-License-Identifier: Apache-2.0
// The sampled loop against a simulation, the continuous poles, and two counts of unstable poles.
#include "firmware/host/design/sampled_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "tests/host/design/delayed_loop.hpp"

namespace fovea::design {
namespace {

SampledLoop RandomLoop(std::mt19937& random, double most_delay_periods) {
  SampledLoop loop;
  loop.plant = test::RandomPlant(random);
  const double omega = test::LogUniform(random, 0.5, 50.0);
  loop.gains = DesignPd(loop.plant, loop.plant.mass * omega * omega, test::LogUniform(random, 0.2, 2.0));
  loop.rate_hz = omega / test::LogUniform(random, 0.01, 1.0);
  loop.delay_s = std::uniform_real_distribution<double>(0.0, most_delay_periods)(random) / loop.rate_hz;
  if (random() % 4 == 0) {
    loop.delay_s = std::round(loop.delay_s * loop.rate_hz) / loop.rate_hz;
  }
  return loop;
}

TEST(SampledLoopTest, OnePeriodMatchesTheSimulation) {
  std::mt19937 random(31);
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    const SampledLoop loop = RandomLoop(random, 5.0);
    const Eigen::MatrixXd A = PeriodMatrix(loop);
    test::DelayedLoop run(loop, {1.0, 0.3 * loop.rate_hz});
    Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
    state.head<2>() << 1.0, 0.3;
    double size = 0.0;
    for (int k = 0; k < 40; ++k) {
      run.Period();
      state = A * state;
      size = std::fmax(size, state.head<2>().norm());
      worst = std::fmax(worst, std::fabs(state[0] - run.motion().x) / size);
      worst = std::fmax(worst, std::fabs(state[1] - run.motion().v / loop.rate_hz) / size);
    }
  }
  std::cout << "largest difference from the simulation: " << worst << " of the state's size\n";
  EXPECT_LT(worst, 1e-7);
}

TEST(SampledLoopTest, HasOnePolePerDelayedForce) {
  const SecondOrder& plant = test::kExercise;
  const PdGains gains = DesignPd(plant, 16.0);
  EXPECT_EQ(Poles(SampledLoop{plant, gains, 1000.0, 0.0}).size(), 2U);
  EXPECT_EQ(Poles(SampledLoop{plant, gains, 1000.0, 0.0004}).size(), 3U);
  EXPECT_EQ(Poles(SampledLoop{plant, gains, 1000.0, 0.001}).size(), 3U);
  for (std::size_t periods = 1; periods < 30; ++periods) {
    const double delay_s = 1e-3 * static_cast<double>(periods);
    EXPECT_EQ(Poles(SampledLoop{plant, gains, 1000.0, delay_s}).size(), 2U + periods)
        << "independent of rounding";
  }
  EXPECT_EQ(Poles(SampledLoop{plant, gains, 1000.0, 0.0031}).size(), 6U);
}

TEST(SampledLoopTest, WithoutGainsEqualsTheSampledOpenLoop) {
  const SecondOrder plant{2.0, 3.0, 50.0};
  const std::vector<std::complex<double>> z = Poles(SampledLoop{plant, {}, 100.0, 0.0});
  const auto s = Poles(plant);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::abs(EquivalentPole(z[i], 100.0) - s[i]), 0.0, 1e-11);
    EXPECT_NEAR(std::abs(z[i] - std::exp(s[i] / 100.0)), 0.0, 1e-14);
  }
}

// Poles by hand: x'' = u sampled with T = 1, without delay: z^2 - (2 - k_v - k_p / 2) z + 1 - k_v + k_p / 2.
TEST(SampledLoopTest, DoubleIntegratorPolesMatchHandComputation) {
  const double k_p = 0.08;
  const double k_v = 0.5;
  const std::vector<std::complex<double>> z = Poles(SampledLoop{{1.0, 0.0, 0.0}, {k_p, k_v}, 1.0, 0.0});
  EXPECT_NEAR((z[0] + z[1]).real(), 2.0 - k_v - k_p / 2.0, 1e-14);
  EXPECT_NEAR((z[0] * z[1]).real(), 1.0 - k_v + k_p / 2.0, 1e-14);
}

// The hold alone delays by half a period, so the pole error is proportional to the period.
TEST(SampledLoopTest, PolesApproachTheContinuousOnesAtHighRates) {
  const SecondOrder plant{2.0, 3.0, 50.0};
  const PdGains gains = DesignPd(plant, 800.0, 0.5);
  const auto s = Poles(CloseLoop(plant, gains));
  double before = 0.0;
  for (const double rate_hz : {1e3, 1e4, 1e5}) {
    const std::vector<std::complex<double>> z = Poles(SampledLoop{plant, gains, rate_hz, 0.0});
    const double off = std::abs(EquivalentPole(z[0], rate_hz) - s[0]) / std::abs(s[0]);
    std::cout << "at " << rate_hz << " Hz the pole is off by " << off << " of its size\n";
    EXPECT_LT(off, 20.0 / rate_hz);
    if (before > 0.0) {
      EXPECT_NEAR(before / off, 10.0, 0.5);
    }
    before = off;
  }
}

TEST(SampledLoopTest, StabilityCountAgreesWithTheEigenvalues) {
  std::mt19937 random(32);
  int stable = 0;
  int most = 0;
  constexpr int kLoops = 3000;
  for (int i = 0; i < kLoops; ++i) {
    const SampledLoop loop = RandomLoop(random, i % 10 == 0 ? 40.0 : 8.0);
    const std::vector<std::complex<double>> poles = Poles(loop);
    const auto outside = static_cast<int>(
        std::count_if(poles.begin(), poles.end(), [](const auto& z) { return std::abs(z) > 1.0; }));
    const std::optional<int> counted = CountUnstablePoles(loop);
    ASSERT_TRUE(counted);
    EXPECT_EQ(*counted, outside);
    EXPECT_EQ(IsStable(loop), outside == 0);
    stable += outside == 0 ? 1 : 0;
    most = std::max(most, outside);
  }
  std::cout << stable << " of " << kLoops << " loops are stable, the worst has " << most
            << " unstable poles\n";
  EXPECT_GT(stable, kLoops / 10);
  EXPECT_LT(stable, kLoops - kLoops / 10);
  EXPECT_GT(most, 4);
}

TEST(SampledLoopTest, PoleOnTheUnitCircleIsNotStable) {
  // Without spring, damping and regulator: a double pole at z = 1. With a spring only: a pair on the circle.
  EXPECT_FALSE(IsStable({{1.0, 0.0, 0.0}, {}, 1000.0, 0.0}));
  EXPECT_FALSE(IsStable({{1.0, 1.0, 0.0}, {}, 1000.0, 0.0}));
  EXPECT_TRUE(IsStable({{1.0, 1.0, 1.0}, {}, 1000.0, 0.0}));
}

}  // namespace
}  // namespace fovea::design
