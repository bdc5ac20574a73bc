// SPDX-License-Identifier: Apache-2.0
// Torque rate limit when the network loses and delays commands.
#include "fovea/franka/torque_rate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <iostream>
#include <limits>
#include <random>

namespace fovea::franka {
namespace {

constexpr double kStep = 1.0;

Vector7 All(double value) {
  Vector7 v;
  v.fill(value);
  return v;
}

// The robot applies commands in order, each at most `late` states after the state that it answers; its next
// state has the applied torque. Returns the largest step between two applied torques [Nm].
double WorstStep(double loss, int late, double wish_size, int ticks) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> even(-wish_size, wish_size);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  std::uniform_int_distribution<int> delay(0, late);
  struct OnItsWay {
    int sent;
    int due;
    Vector7 tau;
  };
  TorqueRate rate(All(kStep));
  std::deque<OnItsWay> link;
  Vector7 tau = All(0.0);
  int applied = -1;
  double worst = 0.0;
  for (int t = 0; t < ticks; ++t) {
    if (chance(random) >= loss) {  // the state arrives
      Vector7 wish;
      std::generate(wish.begin(), wish.end(), [&] { return even(random); });
      Vector7 command;
      rate.Limit(wish, tau, command);
      if (chance(random) >= loss) {
        link.push_back({t, t + delay(random), command});
      }
    }
    // The robot applies the newest command that has arrived.
    for (const OnItsWay& c : link) {
      if (c.due <= t && c.sent > applied) {
        for (std::size_t i = 0; i < tau.size(); ++i) {
          worst = std::max(worst, std::fabs(c.tau[i] - tau[i]));
        }
        tau = c.tau;
        applied = c.sent;
      }
    }
    std::erase_if(link, [t](const OnItsWay& c) { return c.due <= t; });
  }
  return worst;
}

TEST(TorqueRate, StepStaysWithinTheRateOnAnyNetwork) {
  for (const double loss : {0.0, 0.05, 0.5}) {
    for (const int late : {0, 3, 6}) {
      const double worst = WorstStep(loss, late, 30.0, 20'000);
      std::cout << "loss " << loss << ", up to " << late << " states late: largest step " << worst << " Nm\n";
      EXPECT_LE(worst, kStep * (1.0 + 1e-12));
    }
  }
}

TEST(TorqueRate, GoodNetworkUsesTheWholeStep) {
  TorqueRate rate(All(kStep));
  Vector7 tau = All(0.0);
  for (int t = 1; t <= 20; ++t) {
    Vector7 command;
    EXPECT_TRUE(rate.Limit(All(100.0), tau, command));
    EXPECT_EQ(command, All(kStep * t));
    tau = command;
  }
  Vector7 command;
  EXPECT_FALSE(rate.Limit(tau, tau, command));
}

// The robot reports NaN or infinity; the commands stay finite.
TEST(TorqueRate, NonFiniteTorqueIsNeverCommanded) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    TorqueRate rate(All(kStep));
    Vector7 command;
    rate.Limit(All(9.0), All(bad), command);
    EXPECT_EQ(command, All(kStep)) << "a step from zero";
    rate.Limit(All(9.0), All(bad), command);
    EXPECT_LE(command[0], 2.0 * kStep);
    EXPECT_GT(command[0], 0.0);
    rate.Limit(All(9.0), All(kStep), command);
    EXPECT_LE(command[0], 2.0 * kStep) << "limited again from the applied torque once that is finite";
  }
}

TEST(TorqueRate, ClearForgetsTheLastMotion) {
  TorqueRate rate(All(kStep));
  Vector7 command;
  rate.Limit(All(5.0), All(5.0), command);
  rate.Clear();
  rate.Limit(All(9.0), All(0.0), command);
  EXPECT_EQ(command, All(kStep));
}

}  // namespace
}  // namespace fovea::franka
