// SPDX-License-Identifier: Apache-2.0
// Which oscillation of a joint counts as unstable, and which is a normal motion.
#include "sim/panda/swing_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace fovea::sim {
namespace {

// The time at which a joint speed of this amplitude [rad/s] and
// frequency is called unstable [ms]; -1: not within two seconds.
int UnstableAfter(double amplitude, double frequency_hz, double noise = 0.0) {
  SwingWatch watch;
  std::mt19937_64 random(5);
  std::normal_distribution<double> scatter(0.0, 1.0);
  for (int k = 0; k < 2000; ++k) {
    Joints dq = Joints::Zero();
    dq[4] = 0.7 + amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * 1e-3 * k);
    for (double& value : dq) {
      value += noise * scatter(random);
    }
    if (watch.Step(dq)) {
      return k;
    }
  }
  return -1;
}

TEST(SwingWatch, FastAndWideSwingsAreUnstable) {
  const int after = UnstableAfter(0.3, 25.0, 5e-4);
  std::cout << "after " << after << " ms\n";
  EXPECT_GT(after, 100) << "one swing is no instability";
  EXPECT_LT(after, 250);
}

TEST(SwingWatch, SlowOrSmallSwingsAreNotUnstable) {
  EXPECT_EQ(UnstableAfter(2.0, 5.0, 5e-4), -1) << "a slow motion back and forth";
  EXPECT_EQ(UnstableAfter(0.1, 25.0, 5e-4), -1);
  EXPECT_EQ(UnstableAfter(0.0, 1.0, 0.02), -1) << "noise";
}

TEST(SwingWatch, NewMotionResetsTheWatch) {
  SwingWatch watch;
  for (int k = 0; k < 20; ++k) {
    const bool unstable = watch.Step(Joints::Constant(k % 2 == 0 ? 0.5 : -0.5));
    if (unstable) {
      EXPECT_GE(k, 7);
      watch.Clear();
      EXPECT_FALSE(watch.Step(Joints::Constant(-0.5)));
      return;
    }
  }
  FAIL() << "never unstable";
}

}  // namespace
}  // namespace fovea::sim
