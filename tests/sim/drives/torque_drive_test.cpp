// SPDX-License-Identifier: Apache-2.0
// A drive against the analytic answers: lag, delay, rounding, ripple.
#include "sim/drives/torque_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace fovea::sim {
namespace {

constexpr double kTick = hal::kTickPeriodS;
constexpr double kTurn = 2.0 * std::numbers::pi;

// The lag's answer to a unit step at time 0, integrated from 0 to `time_s`.
double IntegralOfStep(double time_s, double bandwidth_hz) {
  const double T = 1.0 / (kTurn * bandwidth_hz);
  return time_s > 0.0 ? time_s - T * (1.0 - std::exp(-time_s / T)) : 0.0;
}

std::vector<double> RandomCommands(int count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> even(-20.0, 20.0);
  std::vector<double> commands(static_cast<std::size_t>(count));
  for (double& tau : commands) {
    tau = even(random);
  }
  return commands;
}

TEST(TorqueDrive, KeepsASettledTorque) {
  TorqueDrive drive({.bandwidth_hz = 70.0, .delay_s = 0.0023});
  EXPECT_EQ(drive.Settle(3.5), 3.5);
  for (int k = 0; k < 10; ++k) {
    EXPECT_DOUBLE_EQ(drive.Step(3.5, 0.0, 0.0), 3.5);
  }
}

// Any staircase of commands is a sum of steps, each answered after the delay.
TEST(TorqueDrive, LagAndDelayAnswerAsTheSumOfTheirSteps) {
  const std::vector<double> commands = RandomCommands(200);
  for (const double bandwidth_hz : {5.0, 60.0, 400.0, 3000.0}) {
    for (const double delay_s : {0.0, 0.0004, 0.001, 0.0037, 0.05}) {
      TorqueDrive drive({.bandwidth_hz = bandwidth_hz, .delay_s = delay_s});
      drive.Settle(0.0);
      double worst = 0.0;
      for (std::size_t n = 0; n < commands.size(); ++n) {
        const double mean = drive.Step(commands[n], 0.0, 0.0);
        double expected = 0.0;
        for (std::size_t k = 0; k <= n; ++k) {
          const double height = commands[k] - (k > 0 ? commands[k - 1] : 0.0);
          const double since_s = kTick * static_cast<double>(n - k) - delay_s;
          expected +=
              height *
              (IntegralOfStep(since_s + kTick, bandwidth_hz) - IntegralOfStep(since_s, bandwidth_hz)) / kTick;
        }
        worst = std::max(worst, std::fabs(mean - expected));
      }
      EXPECT_LT(worst, 1e-11) << bandwidth_hz << " Hz, " << delay_s << " s";
    }
  }
}

TEST(TorqueDrive, DelayOfWholeTicksRepeatsTheCommandsExactly) {
  const std::vector<double> commands = RandomCommands(200);
  for (const std::size_t ticks : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{50}}) {
    TorqueDrive drive({.delay_s = static_cast<double>(ticks) * kTick});
    drive.Settle(1.0);
    for (std::size_t n = 0; n < commands.size(); ++n) {
      EXPECT_DOUBLE_EQ(drive.Step(commands[n], 0.0, 0.0), n < ticks ? 1.0 : commands[n - ticks]) << ticks;
    }
  }
}

TEST(TorqueDrive, DelayOfAPartOfATickMixesTwoCommands) {
  const std::vector<double> commands = RandomCommands(50);
  TorqueDrive drive({.delay_s = 1.4 * kTick});
  drive.Settle(0.0);
  for (std::size_t n = 0; n < commands.size(); ++n) {
    const double expected =
        n < 2 ? (n == 1 ? 0.6 * commands[0] : 0.0) : 0.4 * commands[n - 2] + 0.6 * commands[n - 1];
    EXPECT_NEAR(drive.Step(commands[n], 0.0, 0.0), expected, 1e-12) << n;
  }
}

TEST(TorqueDrive, RefusesADelayBeyondItsRing) {
  EXPECT_NO_THROW(TorqueDrive({.delay_s = kMostDelayTicks * kTick}));
  EXPECT_THROW(TorqueDrive({.delay_s = 1.001 * kMostDelayTicks * kTick}), std::invalid_argument);
  EXPECT_THROW(TorqueDrive({.delay_s = -kTick}), std::invalid_argument);
}

// An even error within half a step has a mean square of a twelfth of the step's.
TEST(TorqueDrive, RoundsToTheNearestStep) {
  constexpr double kQuantum = 0.042;
  TorqueDrive drive({.quantum = kQuantum});
  drive.Settle(0.0);
  double largest = 0.0;
  double square = 0.0;
  constexpr int kCount = 20000;
  for (const double tau : RandomCommands(kCount)) {
    const double delivered = drive.Step(tau, 0.0, 0.0);
    EXPECT_NEAR(delivered / kQuantum, std::round(delivered / kQuantum), 1e-9);
    largest = std::max(largest, std::fabs(delivered - tau));
    square += std::pow(delivered - tau, 2) / kCount;
  }
  std::cout << "error at most " << largest / kQuantum << " steps, mean square "
            << square / (kQuantum * kQuantum) << " (1/12 = 0.08333)\n";
  EXPECT_LE(largest, 0.5 * kQuantum * (1.0 + 1e-12));
  EXPECT_GT(largest, 0.49 * kQuantum);
  EXPECT_NEAR(square, kQuantum * kQuantum / 12.0, 0.02 * kQuantum * kQuantum / 12.0);
}

// At a tenth of a turn per second and 200 periods per turn, the ripple has 20 Hz and nothing else.
TEST(TorqueDrive, RippleHasOneHarmonicOfTheJointsAngle) {
  constexpr double kAmplitude = 0.3;
  constexpr int kTicks = 1000;
  const double dq = 0.1 * kTurn;
  TorqueDrive drive({.ripple = kAmplitude, .ripple_cycles = 200.0, .ripple_phase = 0.7});
  drive.Settle(0.0);
  std::vector<double> tau;
  for (int n = 0; n < kTicks; ++n) {
    tau.push_back(drive.Step(0.0, dq * kTick * n, dq));
  }
  for (int bin = 0; bin <= kTicks / 2; ++bin) {
    std::complex<double> sum = 0.0;
    for (int n = 0; n < kTicks; ++n) {
      sum += tau[static_cast<std::size_t>(n)] * std::polar(2.0 / kTicks, -kTurn * bin * n / kTicks);
    }
    const double x = std::numbers::pi * 20.0 * kTick;  // a mean over a tick is a little smaller
    EXPECT_NEAR(std::abs(sum), bin == 20 ? kAmplitude * std::sin(x) / x : 0.0, 1e-11) << bin << " Hz";
  }
}

// Also when several periods pass within a tick: the mean, by Simpson's rule.
TEST(TorqueDrive, RippleIsItsMeanOverTheTick) {
  for (const double dq : {-0.4, 0.0, 1e-9, 3.0, 25.0, 150.0}) {
    TorqueDrive drive({.ripple = 2.0, .ripple_cycles = 202.0, .ripple_phase = -1.1});
    constexpr double kAngle = 0.37;
    constexpr int kParts = 4000;
    double sum = 0.0;
    for (int k = 0; k <= kParts; ++k) {
      const double weight = k == 0 || k == kParts ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
      sum += weight * 2.0 * std::sin(202.0 * (kAngle + dq * kTick * k / kParts) - 1.1);
    }
    EXPECT_NEAR(drive.Step(0.0, kAngle, dq), sum / (3.0 * kParts), 1e-9) << dq;
  }
}

}  // namespace
}  // namespace fovea::sim
