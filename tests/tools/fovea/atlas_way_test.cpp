// SPDX-License-Identifier: Apache-2.0
// Path search in a plane with a wall, with and without a gap.
#include "tools/fovea/atlas/way.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fovea::atlas {
namespace {

using model::VecN;

VecN At(double x, double y) {
  VecN q(2);
  q << x, y;
  return q;
}

// A wall along x = 0, 0.3 thick, with a gap of `gap` at y = 2.
WayProblem Wall(double gap) {
  WayProblem problem;
  problem.least = At(-3.0, -3.0);
  problem.most = At(3.0, 3.0);
  problem.is_allowed = [gap](const VecN& q) {
    return std::fabs(q[0]) > 0.15 || std::fabs(q[1] - 2.0) < 0.5 * gap;
  };
  problem.pull = [](const VecN& q) { return q; };
  return problem;
}

TEST(AtlasWayTest, PathIsFoundThroughAGapAndNotThroughAWall) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_TRUE(WayExists(Wall(0.5), At(-1.0, -2.0), {At(1.0, -2.0)}, seed)) << seed;
  }
  WayProblem closed = Wall(0.0);
  closed.draws = 2000;
  EXPECT_FALSE(WayExists(closed, At(-1.0, -2.0), {At(1.0, -2.0)}, 1));
  EXPECT_TRUE(WayExists(closed, At(-1.0, -2.0), {At(1.0, -2.0), At(-2.0, 2.0)}, 1))
      << "a path to any one of the goals";
}

// A curve that random postures never hit: reachable only by pulling them onto it.
TEST(AtlasWayTest, PulledPosturesStayOnTheAllowedCurve) {
  WayProblem problem = Wall(0.5);
  problem.is_allowed = [](const VecN& q) { return std::fabs(q[1] - std::sin(q[0])) < 1e-6; };
  problem.draws = 500;
  const VecN start = At(-2.0, std::sin(-2.0));
  const VecN goal = At(2.0, std::sin(2.0));
  EXPECT_FALSE(WayExists(problem, start, {goal}, 1));
  problem.pull = [](const VecN& q) { return At(q[0], std::sin(q[0])); };
  EXPECT_TRUE(WayExists(problem, start, {goal}, 1));
}

TEST(AtlasWayTest, NoPathFromOrToAForbiddenPosture) {
  EXPECT_FALSE(WayExists(Wall(0.5), At(0.0, 0.0), {At(1.0, 0.0)}, 1));
  EXPECT_FALSE(WayExists(Wall(0.5), At(1.0, 0.0), {At(0.0, 0.0)}, 1));
  EXPECT_FALSE(WayExists(Wall(0.5), At(1.0, 0.0), {}, 1));
}

}  // namespace
}  // namespace fovea::atlas
