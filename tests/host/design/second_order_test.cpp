// SPDX-License-Identifier: Apache-2.0
// One degree of freedom: the exercise's figures, and the exact motion compared with a numerical one.
#include "firmware/host/design/second_order.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "tests/host/design/plants.hpp"

namespace fovea::design {
namespace {

TEST(SecondOrderTest, ExerciseOpenLoopIsCriticallyDamped) {
  EXPECT_EQ(DampingRatio(test::kExercise), 1.0);
  EXPECT_EQ(NaturalFrequency(test::kExercise), 0.5);
  for (const std::complex<double>& pole : Poles(test::kExercise)) {
    EXPECT_EQ(pole, -0.5);
  }
}

TEST(SecondOrderTest, ExerciseRegulatorHasItsKnownGains) {
  const PdGains gains = DesignPd(test::kExercise, 16.0);
  EXPECT_EQ(gains.k_p, 12.0);
  EXPECT_EQ(gains.k_v, 16.0);
  const SecondOrder closed = CloseLoop(test::kExercise, gains);
  EXPECT_EQ(DampingRatio(closed), 1.0);
  EXPECT_EQ(NaturalFrequency(closed), 1.0);
}

TEST(SecondOrderTest, GainsGiveTheRequestedStiffnessAndDamping) {
  std::mt19937 random(11);
  for (int i = 0; i < 1000; ++i) {
    const SecondOrder plant = test::RandomPlant(random);
    const double stiffness = test::LogUniform(random, 0.1, 1e4);
    const double zeta = test::LogUniform(random, 0.05, 3.0);
    const SecondOrder closed = CloseLoop(plant, DesignPd(plant, stiffness, zeta));
    EXPECT_NEAR(closed.stiffness, stiffness, 1e-12 * (stiffness + plant.stiffness));
    EXPECT_NEAR(DampingRatio(closed), zeta, 1e-9 * (zeta + DampingRatio(plant)));
  }
}

TEST(SecondOrderTest, PolesSolveTheCharacteristicEquation) {
  double worst = 0.0;
  std::mt19937 random(12);
  for (int i = 0; i < 1000; ++i) {
    const SecondOrder plant = test::RandomPlant(random);
    for (const std::complex<double>& s : Poles(plant)) {
      const double size = plant.mass * std::norm(s) + plant.damping * std::abs(s) + plant.stiffness;
      worst = std::fmax(worst, std::abs(plant.mass * s * s + plant.damping * s + plant.stiffness) /
                                   std::fmax(size, 1e-300));
    }
  }
  std::cout << "worst residual of m s^2 + b s + k: " << worst << " of its terms\n";
  EXPECT_LT(worst, 1e-14);
}

// k = 0, b = 0, both, and poles so far apart that rounding of their sum loses the slow one.
TEST(SecondOrderTest, PolesOfDegenerateSystemsAreExact) {
  EXPECT_EQ(Poles({2.0, 4.0, 0.0}), (std::array<std::complex<double>, 2>{0.0, -2.0}));
  EXPECT_EQ(Poles({1.0, 0.0, 9.0}),
            (std::array<std::complex<double>, 2>{std::complex(0.0, 3.0), std::complex(0.0, -3.0)}));
  EXPECT_EQ(Poles({1.0, 0.0, 0.0}), (std::array<std::complex<double>, 2>{0.0, 0.0}));
  EXPECT_DOUBLE_EQ(Poles({1.0, 1e9, 1.0})[0].real(), -1e-9);
  EXPECT_DOUBLE_EQ(Poles({1.0, -3.0, 2.0})[0].real(), 2.0);
  EXPECT_DOUBLE_EQ(Poles({1.0, -3.0, 2.0})[1].real(), 1.0);
}

TEST(SecondOrderTest, ResponseAgreesWithNumericalIntegration) {
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    SecondOrder plant = test::RandomPlant(random);
    if (i % 3 == 0) {
      // Near critical damping on both sides, from 10 % down to rounding.
      const double off = (i % 2 == 0 ? 1.0 : -1.0) * test::LogUniform(random, 1e-16, 0.1);
      plant.damping = 2.0 * std::sqrt(plant.mass * plant.stiffness) * (1.0 + off);
    }
    const double rate = std::fmax(plant.damping / plant.mass, std::sqrt(plant.stiffness / plant.mass)) + 1e-3;
    const double t_end = test::LogUniform(random, 1e-3, 20.0) / rate;
    test::Motion motion{normal(random), normal(random) * rate};
    const double force = normal(random) * plant.mass * rate * rate;
    const double x0 = motion.x;
    const double v0 = motion.v;
    constexpr int kSteps = 8000;
    double size_x = std::fabs(x0);
    for (int k = 0; k < kSteps; ++k) {
      motion = test::RungeKutta(plant, motion, force, t_end / kSteps);
      size_x = std::fmax(size_x, std::fabs(motion.x));
    }
    worst = std::fmax(worst, std::fabs(Response(plant, x0, v0, force, t_end) - motion.x) / size_x);
    worst = std::fmax(worst,
                      std::fabs(ResponseVelocity(plant, x0, v0, force, t_end) - motion.v) / (rate * size_x));
  }
  std::cout << "largest difference from RK4: " << worst << " of the motion's size\n";
  EXPECT_LT(worst, 1e-11) << "the numerical method's own error is about 3e-12";
}

TEST(SecondOrderTest, ResponseMatchesKnownValues) {
  constexpr double kPi = std::numbers::pi;
  const SecondOrder critical{1.0, 2.0, 1.0};
  EXPECT_DOUBLE_EQ(Response(critical, 1.0, 0.0, 0.0, 3.0), 4.0 * std::exp(-3.0));
  EXPECT_DOUBLE_EQ(ResponseVelocity(critical, 1.0, 0.0, 0.0, 3.0), -3.0 * std::exp(-3.0));
  EXPECT_DOUBLE_EQ(Response(critical, 1.0, 0.0, 0.0, 60.0), 61.0 * std::exp(-60.0)) << "to the last digit";
  const SecondOrder spring{1.0, 0.0, 4.0};
  EXPECT_NEAR(Response(spring, 1.0, 0.0, 0.0, kPi), 1.0, 1e-15);
  EXPECT_NEAR(Response(spring, 0.0, 1.0, 0.0, kPi / 4), 0.5, 1e-15);
  EXPECT_NEAR(Response(spring, 0.0, 0.0, 4.0, kPi / 2), 2.0, 1e-15);
  const SecondOrder free{2.0, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(Response(free, 1.0, 3.0, 4.0, 5.0), 1.0 + 15.0 + 25.0);
  EXPECT_DOUBLE_EQ(ResponseVelocity(free, 1.0, 3.0, 4.0, 5.0), 13.0);
  const SecondOrder brake{2.0, 4.0, 0.0};
  EXPECT_DOUBLE_EQ(Response(brake, 0.0, 6.0, 0.0, 1.0), 3.0 * (1.0 - std::exp(-2.0)));
  EXPECT_DOUBLE_EQ(Response(brake, 0.0, 0.0, 8.0, 100.0), 200.0 - 1.0);
  EXPECT_NEAR(Response({1.0, 0.0, -1.0}, 1.0, 0.0, 0.0, 2.0), std::cosh(2.0), 1e-14);
  // A short time: t^2 / 2 (1 - 2 t / 3). The formula 1 - exp(-t) (1 + t) would keep only four digits.
  EXPECT_NEAR(Response(critical, 0.0, 0.0, 1.0, 1e-6) / 0.5e-12, 1.0 - 2e-6 / 3.0, 1e-12);
  // A stiff overdamped loop after a long time: no overflow on the way.
  EXPECT_DOUBLE_EQ(Response({1.0, 1e6, 1.0}, 0.0, 0.0, 5.0, 1e9), 5.0);
}

// The exercise's disturbance: 8 N on a loop of m k_p' = 16 N/m leaves an offset of 0.5 m.
TEST(SecondOrderTest, ConstantForceLeavesForceOverStiffness) {
  EXPECT_NEAR(Response({16.0, 32.0, 16.0}, 0.0, 0.0, 8.0, 60.0), 0.5, 1e-15);
}

TEST(SecondOrderTest, CriticalDampingSettlesAtTheKnownTime) {
  // (1 + y) exp(-y) = 0.02 at y = 5.8339...
  EXPECT_NEAR(*SettlingTime({16.0, 32.0, 16.0}), 5.833921701917394, 1e-12);
  EXPECT_NEAR(*SettlingTime(test::kExercise), 2.0 * 5.833921701917394, 1e-12);
  const double y = *SettlingTime({16.0, 32.0, 16.0});
  EXPECT_NEAR((1.0 + y) * std::exp(-y), 0.02, 1e-15);
}

TEST(SecondOrderTest, SettlingTimeIsTheLastEntryIntoTheBand) {
  std::mt19937 random(14);
  for (int i = 0; i < 200; ++i) {
    SecondOrder plant = test::RandomPlant(random);
    plant.damping += 0.02 * std::sqrt(plant.mass * (plant.stiffness += 0.01));
    const double band = test::LogUniform(random, 1e-4, 0.5);
    const std::optional<double> settled = SettlingTime(plant, band);
    ASSERT_TRUE(settled);
    const auto rest = [&](double t) { return std::fabs(Response(plant, 1.0, 0.0, 0.0, t)); };
    EXPECT_NEAR(rest(*settled), band, 1e-12);
    EXPECT_GT(rest(*settled * (1.0 - 1e-8)), band);
    double largest = 0.0;
    for (int k = 1; k <= 5000; ++k) {
      largest = std::fmax(largest, rest(*settled * (1.0 + 0.002 * k)));
    }
    EXPECT_LE(largest, band);
  }
}

TEST(SecondOrderTest, SystemThatNeverSettlesHasNoSettlingTime) {
  EXPECT_FALSE(SettlingTime({1.0, 1.0, 0.0}));
  EXPECT_FALSE(SettlingTime({1.0, 0.0, 1.0}));
  EXPECT_FALSE(SettlingTime({1.0, -1.0, 1.0}));
  EXPECT_FALSE(SettlingTime({1.0, 1.0, -1.0}));
}

}  // namespace
}  // namespace fovea::design
