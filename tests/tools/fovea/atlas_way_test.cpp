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
    EXPECT_TRUE(FindWay(Wall(0.5), At(-1.0, -2.0), {At(1.0, -2.0)}, seed).found) << seed;
  }
  WayProblem closed = Wall(0.0);
  closed.draws = 2000;
  EXPECT_FALSE(FindWay(closed, At(-1.0, -2.0), {At(1.0, -2.0)}, 1).found);
  EXPECT_TRUE(FindWay(closed, At(-1.0, -2.0), {At(1.0, -2.0), At(-2.0, 2.0)}, 1).found)
      << "a path to any one of the goals";
}

// The way around the wall, and back: 8.0 by the shortest path.
TEST(AtlasWayTest, LengthIsThatOfAPathWithShortcuts) {
  const double across = 0.3;
  const double shortest = 2.0 * std::hypot(0.85, 3.75) + across;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const WayResult way = FindWay(Wall(0.5), At(-1.0, -2.0), {At(1.0, -2.0)}, seed);
    EXPECT_GE(way.length, shortest - 0.1) << "each of the gap's corners may be cut by less than a step";
    EXPECT_LE(way.length, 1.15 * shortest) << seed;
    EXPECT_LT(way.draws, 60000);
  }
  WayProblem closed = Wall(0.0);
  closed.draws = 500;
  const WayResult none = FindWay(closed, At(-1.0, -2.0), {At(1.0, -2.0)}, 1);
  EXPECT_EQ(none.draws, 500);
  EXPECT_EQ(none.length, 0.0);
}

// A curve that random postures never hit: reachable only by pulling them onto it.
TEST(AtlasWayTest, PulledPosturesStayOnTheAllowedCurve) {
  WayProblem problem = Wall(0.5);
  problem.is_allowed = [](const VecN& q) { return std::fabs(q[1] - std::sin(q[0])) < 1e-6; };
  problem.draws = 500;
  const VecN start = At(-2.0, std::sin(-2.0));
  const VecN goal = At(2.0, std::sin(2.0));
  EXPECT_FALSE(FindWay(problem, start, {goal}, 1).found);
  problem.pull = [](const VecN& q) { return At(q[0], std::sin(q[0])); };
  EXPECT_TRUE(FindWay(problem, start, {goal}, 1).found);
}

TEST(AtlasWayTest, NoPathFromOrToAForbiddenPosture) {
  EXPECT_FALSE(FindWay(Wall(0.5), At(0.0, 0.0), {At(1.0, 0.0)}, 1).found);
  EXPECT_FALSE(FindWay(Wall(0.5), At(1.0, 0.0), {At(0.0, 0.0)}, 1).found);
  EXPECT_FALSE(FindWay(Wall(0.5), At(1.0, 0.0), {}, 1).found);
}

}  // namespace
}  // namespace fovea::atlas
