// SPDX-License-Identifier: Apache-2.0
// What a whole run finds out, beside what its [truth] drew.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/truth/truth_draw.hpp"
#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

const beliefs::Belief& Find(const sim::Summary& s, const std::string& name) {
  for (const beliefs::Belief& belief : s.beliefs.value().beliefs) {
    if (belief.name == name) {
      return belief;
    }
  }
  throw std::logic_error("there is no belief " + name);
}

const sim::TrueValue& TruthOf(const sim::Summary& s, sim::Quantity quantity) {
  for (const sim::TrueValue& value : s.truth) {
    if (value.quantity == quantity) {
      return value;
    }
  }
  throw std::logic_error("nothing was drawn");
}

// A run finds what it was made for, with the goals of the standard deviations.
TEST(Findings, OfTheExcitingMotion) {
  struct Expected {
    const char* name;
    sim::Quantity quantity;
    std::size_t entry;
    double sigma_most;
  };
  constexpr std::array<Expected, 6> kExpected{
      {{"latency", sim::Quantity::kLatency, 0, 2.0},
       {"mount turn about the camera\'s x axis", sim::Quantity::kMountTurn, 0, 0.3},
       {"mount turn about the camera\'s y axis", sim::Quantity::kMountTurn, 1, 0.3},
       {"mount turn about the camera\'s z axis", sim::Quantity::kMountTurn, 2, 0.3},
       {"focal length", sim::Quantity::kFocalLength, 0, 0.5},
       {"load", sim::Quantity::kLoadMass, 0, 0.05}}};
  for (const char* seed : {"run.seed=2001", "run.seed=2002", "run.seed=2003"}) {
    const sim::Summary s = RunShipped("ball-exciting", {seed});
    ExpectSound(s);
    EXPECT_EQ(s.verdict, "the commanded motion was followed");
    EXPECT_TRUE(s.converged);
    EXPECT_FALSE(s.beliefs.value().verdict.empty());
    for (const Expected& expected : kExpected) {
      const sim::TrueValue& truth = TruthOf(s, expected.quantity);
      const double believed = truth.believed[expected.entry];
      const double actual = truth.actual[expected.entry];
      const bool relative = expected.quantity == sim::Quantity::kFocalLength;
      const double difference = relative ? 100.0 * (actual / believed - 1.0) : actual - believed;
      const beliefs::Belief& belief = Find(s, expected.name);
      fmt::print("{} {:<20} {:8.4f} +- {:.4f} {}, truly {:8.4f}\n", seed, belief.name, belief.difference,
                 belief.sigma, belief.unit, difference);
      EXPECT_TRUE(belief.IsKnown()) << belief.name;
      EXPECT_LE(belief.sigma, expected.sigma_most) << belief.name;
      EXPECT_LE(std::fabs(belief.difference - difference), 4.0 * belief.sigma) << belief.name;
    }
  }
}

// An approach to a ball with right beliefs gives nothing to complain of.
TEST(Findings, OfRightBeliefs) {
  const sim::Summary s = RunShipped("ball");
  for (const std::string& sentence : s.beliefs.value().verdict) {
    fmt::print("{}\n", sentence);
  }
  EXPECT_TRUE(s.beliefs.value().verdict.empty());
}

}  // namespace
}  // namespace fovea::test
