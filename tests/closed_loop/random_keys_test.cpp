// SPDX-License-Identifier: Apache-2.0
// Random keys of `servo` and `safety`, drawn together from their ranges, half of them at an end of the range.
// Whether the configuration is refused or runs, the true arm keeps its limits.
//
// The keys of springs are not drawn, and gains have the lower bounds below: otherwise the arm swings about a
// reference that keeps the limits (SAFETY.md states by how much).
#include <cmath>
#include <cstdio>
#include <random>
#include <set>

#include "firmware/host/config/input_error.hpp"
#include "tests/closed_loop/closed_loop.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::test {
namespace {

const std::set<std::string> kNotDrawn{"servo.motion_law", "servo.k_p", "servo.k_v"};
constexpr double kLeastOmegaN = 10.0;
constexpr double kLeastZeta = 0.5;

class KeyDraw {
 public:
  explicit KeyDraw(unsigned seed) : engine_(seed) {
    const config::KeyTable table = sim::ScenarioKeys(scenario_);
    for (const config::Key& key : table.keys()) {
      Range range{key.name, 0.0, 0.0, key.kind == "a whole number"};
      const bool is_ours = key.name.starts_with("servo.") || key.name.starts_with("safety.");
      if (is_ours && !kNotDrawn.contains(key.name) && (range.whole || key.kind == "a number") &&
          std::sscanf(key.allowed.c_str(), "%lf to %lf", &range.least, &range.most) == 2) {
        range.least = key.name == "servo.omega_n" ? kLeastOmegaN : range.least;
        range.least = key.name == "servo.zeta" ? kLeastZeta : range.least;
        ranges_.push_back(range);
      }
    }
  }

  std::size_t size() const { return ranges_.size(); }

  std::vector<std::string> Assignments() {
    std::vector<std::string> drawn;
    for (int i = std::uniform_int_distribution<int>(1, 6)(engine_); i > 0; --i) {
      const Range& range =
          ranges_[std::uniform_int_distribution<std::size_t>(0, ranges_.size() - 1)(engine_)];
      const double value = ValueIn(range);
      drawn.push_back(range.name + '=' +
                      (range.whole ? std::to_string(std::lround(value)) : std::to_string(value)));
    }
    return drawn;
  }

 private:
  struct Range {
    std::string name;
    double least;
    double most;
    bool whole;
  };

  double ValueIn(const Range& range) {
    const auto uniform = [this](double a, double b) {
      return std::uniform_real_distribution<double>(a, b)(engine_);
    };
    switch (std::uniform_int_distribution<int>(0, 3)(engine_)) {
      case 0: return range.least;
      case 1: return range.most;
      case 2: {  // every order of magnitude equally likely
        const double least = std::max(range.least, 1e-5 * range.most);
        return std::exp(uniform(std::log(least), std::log(range.most)));
      }
      default: return uniform(range.least, range.most);
    }
  }

  std::mt19937_64 engine_;
  sim::Scenario scenario_;
  std::vector<Range> ranges_;
};

TEST(RandomKeysTest, TrueArmKeepsItsLimitsOrTheKeysAreRefused) {
  KeyDraw draw(7331);
  EXPECT_GT(draw.size(), 80U) << "the keys are not found";
  const int runs = Repetitions(60);
  int refused = 0;
  for (int k = 0; k < runs; ++k) {
    std::vector<std::string> keys{"run.duration_s=4", "motion.lead_s=2", "motion.rate_hz=1.5"};
    std::string all;
    for (const std::string& key : draw.Assignments()) {
      keys.push_back(key);
      all += key + ' ';
    }
    try {
      const sim::Summary s = RunShipped("flange-circle", keys);
      EXPECT_EQ(s.limit_violations, 0U) << all;
      EXPECT_EQ(s.contact_ticks, 0U) << all;
    } catch (const config::InputError&) {
      ++refused;
    }
  }
  std::cout << draw.size() << " keys; " << refused << " of " << runs << " configurations refused\n";
  EXPECT_LT(refused, runs / 4) << "too many configurations are refused";
}

}  // namespace
}  // namespace fovea::test
