// SPDX-License-Identifier: Apache-2.0
// Our sin, cos and atan2 against the C library in extended precision.
#include "firmware/core/model/math.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <random>

#include "firmware/core/model/log.hpp"

namespace fovea::model {
namespace {

TEST(SinCosTest, IsWithinItsStatedError) {
  std::mt19937_64 engine(1);
  for (const double size : {0.5, 3.2, 100.0, kSinCosMaxArgument}) {
    std::uniform_real_distribution<double> uniform(-size, size);
    long double worst = 0.0L;
    for (int i = 0; i < 1'000'000; ++i) {
      const double x = uniform(engine);
      const SinCosResult r = SinCos(x);
      worst =
          std::max(worst, std::fabs(static_cast<long double>(r.sin) - std::sin(static_cast<long double>(x))));
      worst =
          std::max(worst, std::fabs(static_cast<long double>(r.cos) - std::cos(static_cast<long double>(x))));
    }
    std::cout << "|x| <= " << size << ": worst error " << static_cast<double>(worst) << "\n";
    EXPECT_LT(worst, 1.2e-16L);
  }
}

TEST(SinCosTest, IsExactAtZeroAndSymmetric) {
  EXPECT_EQ(SinCos(0.0).sin, 0.0);
  EXPECT_EQ(SinCos(0.0).cos, 1.0);
  EXPECT_EQ(SinCos(-1.0).sin, -SinCos(1.0).sin);
  EXPECT_EQ(SinCos(-1.0).cos, SinCos(1.0).cos);
}

TEST(SinCosTest, NonFiniteOrTooLargeArgumentGivesNan) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double x : {1.0001e5, -1.0001e5, kInfinity, -kInfinity, std::nan("")}) {
    EXPECT_TRUE(std::isnan(SinCos(x).sin)) << x;
    EXPECT_TRUE(std::isnan(SinCos(x).cos)) << x;
  }
}

TEST(Atan2Test, IsWithinItsStatedError) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  std::uniform_real_distribution<double> log_size(-100.0, 100.0);
  long double worst = 0.0L;
  for (int i = 0; i < 1'000'000; ++i) {
    const double a = angle(engine);
    const double size = std::pow(10.0, log_size(engine));
    const double x = size * std::cos(a);
    const double y = size * std::sin(a);
    const long double truth = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    worst = std::max(worst, std::fabs(static_cast<long double>(Atan2(y, x)) - truth));
  }
  std::cout << "worst error " << static_cast<double>(worst) << " rad\n";
  EXPECT_LT(worst, 4.5e-16L);
}

TEST(Atan2Test, IsExactOnTheAxesAndNanForNonFiniteInput) {
  EXPECT_EQ(Atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(Atan2(0.0, 2.0), 0.0);
  EXPECT_EQ(Atan2(0.0, -2.0), kPi);
  EXPECT_EQ(Atan2(3.0, 0.0), 0.5 * kPi);
  EXPECT_EQ(Atan2(-3.0, 0.0), -0.5 * kPi);
  EXPECT_TRUE(std::isnan(Atan2(std::nan(""), 1.0)));
  EXPECT_TRUE(std::isnan(Atan2(1.0, std::numeric_limits<double>::infinity())));
}

TEST(LogTest, IsWithinItsStatedError) {
  std::mt19937_64 engine(3);
  for (const double size : {0.01, 0.7, 2.0, 700.0}) {
    std::uniform_real_distribution<double> uniform(-size, size);
    long double worst = 0.0L;
    for (int i = 0; i < 1'000'000; ++i) {
      const double x = std::exp(uniform(engine));
      const long double exact = std::log(static_cast<long double>(x));
      worst = std::max(worst, std::fabs(static_cast<long double>(Log(x)) - exact) /
                                  std::max(1.0L, std::fabs(exact) / 2.0L));
    }
    std::cout << "|ln x| <= " << size << ": worst error " << static_cast<double>(worst) << "\n";
    EXPECT_LT(worst, 4e-16L);
  }
  EXPECT_EQ(Log(1.0), 0.0);
}

TEST(LogTest, OnlyOfNormalPositiveNumbers) {
  for (const double x : {0.0, -0.0, -1.0, 1e-310, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_TRUE(std::isnan(Log(x))) << x;
  }
  EXPECT_FALSE(std::isnan(Log(std::numeric_limits<double>::max())));
  EXPECT_FALSE(std::isnan(Log(std::numeric_limits<double>::min())));
}

}  // namespace
}  // namespace fovea::model
