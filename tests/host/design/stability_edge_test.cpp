// SPDX-License-Identifier: Apache-2.0
// Stability edges: a simulation decays just below an edge and
// grows just above it, and every smaller value is stable.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

#include "firmware/host/design/sampled_loop.hpp"
#include "tests/host/design/delayed_loop.hpp"

namespace fovea::design {
namespace {

using test::Fate;
using test::FateOf;

double SpectralRadius(const SampledLoop& loop) { return std::abs(Poles(loop).front()); }

SampledLoop WithFactor(SampledLoop loop, double factor) {
  loop.gains.k_p *= factor;
  loop.gains.k_v *= factor;
  return loop;
}

SampledLoop WithDelay(SampledLoop loop, double delay_s) {
  loop.delay_s = delay_s;
  return loop;
}

// The exercise at 1 kHz; plants without spring, without damping, with neither; negative gains.
std::vector<SampledLoop> ChosenLoops() {
  const SecondOrder& plant = test::kExercise;
  return {
      {plant, DesignPd(plant, 16.0), 1000.0, 0.0},
      {plant, DesignPd(plant, 16.0), 1000.0, 0.0025},
      {plant, DesignPd(plant, 16.0), 20.0, 0.37},
      {{2.0, 0.0, 0.0}, DesignPd({2.0, 0.0, 0.0}, 800.0, 0.7), 1000.0, 0.004},
      {{2.0, 5.0, 0.0}, DesignPd({2.0, 5.0, 0.0}, 200.0, 1.0), 200.0, 0.0033},
      {{1.0, 0.0, 9.0}, DesignPd({1.0, 0.0, 9.0}, 100.0, 0.5), 100.0, 0.025},
      {{1.0, 20.0, 9.0}, DesignPd({1.0, 20.0, 9.0}, 25.0, 0.5), 100.0, 0.01},
      {{1.0, 3.0, 100.0}, DesignPd({1.0, 3.0, 100.0}, 60.0, 1.5), 200.0, 0.01},
  };
}

SampledLoop RandomStableLoop(std::mt19937& random) {
  for (;;) {
    SampledLoop loop;
    loop.plant = test::RandomPlant(random);
    const double omega = test::LogUniform(random, 0.5, 50.0);
    loop.gains = DesignPd(loop.plant, loop.plant.mass * omega * omega, test::LogUniform(random, 0.3, 2.0));
    loop.rate_hz = omega / test::LogUniform(random, 0.02, 0.4);
    loop.delay_s = std::uniform_real_distribution<double>(0.0, 6.0)(random) / loop.rate_hz;
    if (IsStable(loop)) {
      return loop;
    }
  }
}

std::vector<SampledLoop> Loops() {
  std::vector<SampledLoop> loops = ChosenLoops();
  std::mt19937 random(41);
  while (loops.size() < 60) {
    loops.push_back(RandomStableLoop(random));
  }
  return loops;
}

TEST(StabilityEdgeTest, ExerciseEdgesMatchHandComputation) {
  const SampledLoop loop{test::kExercise, DesignPd(test::kExercise, 16.0), 1000.0, 0.0};
  // |L| = 1 at 1 rad/s, with a phase margin of pi - atan(4/3)
  // + atan(3/4). The hold costs half a period of delay.
  const double phase_margin = std::numbers::pi - std::atan2(16.0, -12.0) + std::atan2(16.0, 12.0);
  EXPECT_NEAR(*DelayEdge(loop).at, phase_margin - 0.0005, 1e-6);
  // The edge is at z = -1, where k_v = 2 m / T; the plant's damping changes it by one part in 2000.
  EXPECT_NEAR(*GainEdge(loop).at, 2000.0, 1.0);
  EXPECT_TRUE(DelayEdge(loop).searched_to >= 40.0);
}

TEST(StabilityEdgeTest, SimulationDecaysBeforeTheGainEdgeAndGrowsAfterIt) {
  int edges = 0;
  double worst = 0.0;
  for (const SampledLoop& loop : Loops()) {
    const StabilityEdge edge = GainEdge(loop);
    if (!edge.at) {
      continue;
    }
    ++edges;
    EXPECT_GT(*edge.at, 1.0);
    EXPECT_EQ(FateOf(WithFactor(loop, 0.98 * *edge.at)), Fate::kDecays) << edges;
    EXPECT_EQ(FateOf(WithFactor(loop, 1.02 * *edge.at)), Fate::kGrows) << edges;
    worst = std::fmax(worst, std::fabs(SpectralRadius(WithFactor(loop, *edge.at)) - 1.0));
  }
  std::cout << edges << " edges; at them the spectral radius is off 1 by " << worst << " at most\n";
  EXPECT_GT(edges, 50);
  EXPECT_LT(worst, 1e-9);
}

TEST(StabilityEdgeTest, SimulationDecaysBeforeTheDelayEdgeAndGrowsAfterIt) {
  int edges = 0;
  int narrow = 0;
  double worst = 0.0;
  for (const SampledLoop& loop : Loops()) {
    const StabilityEdge edge = DelayEdge(loop);
    if (!edge.at) {
      continue;
    }
    ++edges;
    EXPECT_EQ(FateOf(WithDelay(loop, 0.98 * *edge.at)), Fate::kDecays) << edges;
    if (FateOf(WithDelay(loop, 1.02 * *edge.at)) != Fate::kGrows) {
      // A slightly longer delay can stabilise a fast mode again.
      EXPECT_EQ(FateOf(WithDelay(loop, 1.005 * *edge.at)), Fate::kGrows) << edges;
      ++narrow;
    }
    if (*edge.at * loop.rate_hz < 100.0) {
      worst = std::fmax(worst, std::fabs(SpectralRadius(WithDelay(loop, *edge.at)) - 1.0));
    }
  }
  std::cout << edges << " edges, " << narrow
            << " of them followed by an unstable range below 2 %; at them the spectral radius "
            << "is off 1 by " << worst << " at most\n";
  EXPECT_GT(edges, 45);
  EXPECT_LE(narrow, 1);
  EXPECT_LT(worst, 1e-9);
}

// An oscillating plant is damped by some delays and excited by
// others. The edge is the start of the first unstable range.
TEST(StabilityEdgeTest, DelayEdgeIsTheFirstOfSeveral) {
  for (const PdGains& gains : {PdGains{0.5, 0.3}, PdGains{0.0, 0.3}, PdGains{0.5, 0.1}}) {
    const SampledLoop loop{{1.0, 0.2, 1.0}, gains, 5.0, 0.0};
    const double edge = DelayEdge(loop).at.value();
    int changes = 0;
    bool stable = true;
    for (int i = 0; i < 450; ++i) {
      const double delay_s = 0.02 * i;
      const bool now = SpectralRadius(WithDelay(loop, delay_s)) < 1.0;
      if (delay_s < edge) {
        EXPECT_TRUE(now) << delay_s;
      }
      changes += now != stable ? 1 : 0;
      stable = now;
    }
    std::cout << "edge at " << edge << " s, " << changes << " edges up to 9 s\n";
    EXPECT_GE(changes, 3) << "otherwise this test proves nothing";
    EXPECT_GT(SpectralRadius(WithDelay(loop, 1.001 * edge)), 1.0);
  }
}

// A stiff plant softened by its regulator is unstable only for delays from about 6.0 to 6.1 periods.
TEST(StabilityEdgeTest, FindsAnUnstableDelayRangeOfLessThanTwoPercent) {
  const SampledLoop loop{{12.1043, 665.625, 3004.8}, {-2963.54, -646.537}, 22.7676, 0.0};
  const double edge = DelayEdge(loop).at.value();
  EXPECT_NEAR(edge * loop.rate_hz, 5.989, 0.001);
  EXPECT_EQ(FateOf(WithDelay(loop, 0.98 * edge)), Fate::kDecays);
  EXPECT_EQ(FateOf(WithDelay(loop, 1.005 * edge)), Fate::kGrows);
  EXPECT_EQ(FateOf(WithDelay(loop, 1.03 * edge)), Fate::kDecays) << "otherwise this test proves nothing";
}

TEST(StabilityEdgeTest, EveryGainBelowTheEdgeIsStable) {
  std::mt19937 random(42);
  for (int i = 0; i < 30; ++i) {
    const SampledLoop loop = RandomStableLoop(random);
    const double edge = GainEdge(loop).at.value_or(1e3);
    for (int k = 0; k < 300; ++k) {
      const double factor = std::pow(edge, k / 300.0);
      EXPECT_LT(SpectralRadius(WithFactor(loop, factor)), 1.0) << factor;
    }
  }
}

// Too much delay for these gains: the edge is the factor below 1 at which the loop becomes stable.
TEST(StabilityEdgeTest, UnstableLoopHasAGainEdgeBelowOne) {
  const SampledLoop loop{test::kExercise, DesignPd(test::kExercise, 16.0), 100.0, 2.5};
  ASSERT_FALSE(IsStable(loop));
  const double edge = GainEdge(loop).at.value();
  EXPECT_LT(edge, 1.0);
  EXPECT_EQ(FateOf(WithFactor(loop, 0.98 * edge)), Fate::kDecays);
  EXPECT_EQ(FateOf(WithFactor(loop, 1.02 * edge)), Fate::kGrows);
  EXPECT_LT(*DelayEdge(loop).at, 2.5) << "the delay edge counts from zero delay";
}

TEST(StabilityEdgeTest, LoopWithoutAnEdgeReportsNone) {
  // Gains too weak to destabilise the plant at any delay.
  const SampledLoop weak{{1.0, 2.0, 1.0}, {0.1, 0.1}, 100.0, 0.0};
  const StabilityEdge delay = DelayEdge(weak);
  EXPECT_FALSE(delay.at);
  EXPECT_GE(delay.searched_to, 20.0);
  EXPECT_EQ(FateOf(WithDelay(weak, 0.97 * delay.searched_to)), Fate::kDecays);
  const StabilityEdge gain = GainEdge({{1.0, 2.0, 1.0}, {}, 100.0, 0.0});
  EXPECT_FALSE(gain.at);
  EXPECT_EQ(gain.searched_to, 1e6);
  // Unstable without delay, because the sampling is too slow.
  EXPECT_EQ(DelayEdge({{1.0, 0.0, 0.0}, {100.0, 20.0}, 5.0, 0.0}).at, 0.0);
}

}  // namespace
}  // namespace fovea::design
