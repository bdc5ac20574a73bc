// SPDX-License-Identifier: Apache-2.0
// True values: drawn as their distribution says, checked for all draws, and the same for the same seed.
#include "sim/truth/deviation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "sim/truth/truth_draw.hpp"
#include "tests/support/input_error.hpp"

namespace fovea::sim {
namespace {

using testing::HasSubstr;

TEST(Deviation, FormsApplyInTheirOrder) {
  Deviation d;
  EXPECT_FALSE(d.IsAny());
  EXPECT_EQ(Draw(d, {1.0, 2.0}, 3), (std::vector{1.0, 2.0}));
  d.scale = {3.0};
  d.offset = {0.5, -0.5};
  EXPECT_TRUE(d.IsAny());
  EXPECT_EQ(Draw(d, {1.0, 2.0}, 3), (std::vector{3.5, 5.5}));
  d = {};
  d.value = {10.0};
  EXPECT_EQ(Draw(d, {1.0, 2.0}, 3), (std::vector{10.0, 10.0}));
}

struct Moments {
  double mean = 0.0;
  double sigma = 0.0;
};
Moments MomentsOf(const Deviation& d, double believed) {
  constexpr int kDraws = 20000;
  const Span span = SpansOf(d, {believed})[0];
  double sum = 0.0;
  double sum2 = 0.0;
  double least = INFINITY;
  double most = -INFINITY;
  for (int seed = 0; seed < kDraws; ++seed) {
    const double value = Draw(d, {believed}, static_cast<std::uint64_t>(seed))[0];
    sum += value;
    sum2 += value * value;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  EXPECT_GE(least, span.low);
  EXPECT_LE(most, span.high);
  EXPECT_LT((least - span.low) / (span.high - span.low), 0.1) << "the span is no larger than needed";
  EXPECT_LT((span.high - most) / (span.high - span.low), 0.1);
  const double mean = sum / kDraws;
  return {mean, std::sqrt(sum2 / kDraws - mean * mean)};
}

// A normal number cut off at three standard deviations has a standard deviation of 0.9866 of them.
TEST(Deviation, DrawsHaveTheMomentsOfTheirDistribution) {
  Deviation normal;
  normal.sigma = {0.2};
  Moments m = MomentsOf(normal, 5.0);
  EXPECT_NEAR(m.mean, 5.0, 0.005);
  EXPECT_NEAR(m.sigma, 0.9866 * 0.2, 0.003);
  Deviation uniform;
  uniform.range = {-1.0, 3.0};
  m = MomentsOf(uniform, 5.0);
  EXPECT_NEAR(m.mean, 6.0, 0.03);
  EXPECT_NEAR(m.sigma, 4.0 / std::sqrt(12.0), 0.03);
  Deviation factor;
  factor.scale_sigma = {0.1};
  m = MomentsOf(factor, -2.0);
  EXPECT_NEAR(m.mean, -2.0, 0.01);
  EXPECT_NEAR(m.sigma, 0.9866 * 0.2, 0.003);
  Deviation factors;
  factors.scale_range = {0.5, 1.5};
  m = MomentsOf(factors, 4.0);
  EXPECT_NEAR(m.mean, 4.0, 0.03);
  EXPECT_NEAR(m.sigma, 4.0 / std::sqrt(12.0), 0.03);
}

// Neither the entries of a list nor two quantities are drawn alike.
TEST(Deviation, DrawsAreIndependent) {
  Deviation d;
  d.sigma = {1.0};
  double product = 0.0;
  constexpr int kDraws = 20000;
  for (int seed = 0; seed < kDraws; ++seed) {
    const std::vector<double> drawn = Draw(d, {0.0, 0.0}, static_cast<std::uint64_t>(seed));
    product += drawn[0] * drawn[1] / kDraws;
  }
  EXPECT_NEAR(product, 0.0, 0.03);
  // Two quantities of one seed: their draws are not correlated.
  TruthSettings two_of_them;
  for (const Quantity quantity : {Quantity::kMountTurn, Quantity::kClockDrift}) {
    two_of_them.of[static_cast<std::size_t>(quantity)].sigma = {1.0};
  }
  product = 0.0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    TruthDraw draw(two_of_them, seed);
    product += draw.Get(Quantity::kMountTurn, {0.0})[0] * draw.Get(Quantity::kClockDrift, {0.0})[0] / kDraws;
  }
  EXPECT_NEAR(product, 0.0, 0.03);
  TruthSettings alone;
  alone.of[static_cast<std::size_t>(Quantity::kLoadMass)].sigma = {0.01};
  TruthSettings both = alone;
  both.of[static_cast<std::size_t>(Quantity::kLatency)].sigma = {1.0};
  TruthDraw one(alone, 7);
  TruthDraw two(both, 7);
  static_cast<void>(two.Get(Quantity::kLatency, {40.0}));
  EXPECT_EQ(one.Get(Quantity::kLoadMass, {0.25}), two.Get(Quantity::kLoadMass, {0.25}))
      << "a key does not change the draw of another";
  EXPECT_EQ(two.differing().size(), 2U);
  TruthDraw other(alone, 8);
  EXPECT_NE(TruthDraw(alone, 7).Get(Quantity::kLoadMass, {0.25}), other.Get(Quantity::kLoadMass, {0.25}));
}

TEST(TruthDraw, RefusesWhatACouldBeDrawnAndIsImpossible) {
  TruthSettings settings;
  Deviation& mass = settings.of[static_cast<std::size_t>(Quantity::kLoadMass)];
  mass.sigma = {0.1};
  // Refused for every seed, though most draws would be allowed.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_THAT(test::InputErrorOf([&] { TruthDraw(settings, seed).Get(Quantity::kLoadMass, {0.25}); }),
                HasSubstr("truth.arm.load_mass is not allowed: entry 1 could be from -0.05 to 0.55 kg; "
                          "allowed is 0 to 100 kg"));
  }
  mass.sigma = {0.05};
  EXPECT_EQ(test::InputErrorOf([&] { TruthDraw(settings, 1).Get(Quantity::kLoadMass, {0.25}); }), "");
  settings.of[static_cast<std::size_t>(Quantity::kLoadCentre)].offset = {0.1, 0.2};
  EXPECT_THAT(test::InputErrorOf([&] {
                TruthDraw(settings, 1).Get(Quantity::kLoadCentre, {0.0, 0.0, 0.0});
              }),
              HasSubstr("truth.arm.load_com.offset has 2 entries: 1 or 3 are allowed"));
}

TEST(TruthDraw, RefusesFormsThatContradictOrChangeNothing) {
  TruthSettings settings;
  Deviation& mass = settings.of[static_cast<std::size_t>(Quantity::kLoadMass)];
  const auto error = [&](double believed) {
    return test::InputErrorOf([&] { TruthDraw(settings, 1).Get(Quantity::kLoadMass, {believed}); });
  };
  mass.range = {0.2, -0.2};
  EXPECT_THAT(error(0.5), HasSubstr("truth.arm.load_mass.range = [0.2, -0.2] is not allowed: the smaller"));
  mass = {};
  mass.scale_range = {1.1, 0.9};
  EXPECT_THAT(error(0.5),
              HasSubstr("truth.arm.load_mass.scale_range = [1.1, 0.9] is not allowed: the smaller"));
  mass = {};
  mass.value = {0.5};
  mass.sigma = {0.1};
  EXPECT_THAT(error(0.5),
              HasSubstr("truth.arm.load_mass is not allowed as a value and as a difference at once"));
  mass = {};
  mass.scale = {1.2};
  EXPECT_EQ(error(0.5), "");
  EXPECT_THAT(error(0.0), HasSubstr("truth.arm.load_mass has no effect: the servo believes 0, and a factor"));
  mass.offset = {0.1};
  EXPECT_EQ(error(0.0), "");
}

}  // namespace
}  // namespace fovea::sim
