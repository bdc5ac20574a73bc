// SPDX-License-Identifier: Apache-2.0
// Distances to planes and boxes, against searches.
#include "firmware/core/barriers/obstacle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

namespace fovea::barriers {
namespace {

TEST(ObstacleTest, PlaneDistanceMatchesItsEquation) {
  config::Obstacles obstacles;
  obstacles.num_planes = 1;
  obstacles.planes[0] = {model::Vec3(0.0, 0.6, 0.8), 0.2};
  const Clearance clearance = ClearanceOf(obstacles, 0, {1.0, 1.0, 1.0});
  EXPECT_DOUBLE_EQ(clearance.distance, 1.2);
  EXPECT_EQ(clearance.away, obstacles.planes[0].normal);
  EXPECT_EQ(CountObstacles(obstacles), 1);
}

TEST(ObstacleTest, BoxDistanceIsThatOfItsNearestPoint) {
  config::Obstacles obstacles;
  obstacles.num_boxes = 1;
  config::Box& box = obstacles.boxes[0];
  box = {{-0.1, -0.2, 0.0}, {0.3, 0.1, 0.5}};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double worst = 0.0;
  int inside = 0;
  for (int n = 0; n < 20000; ++n) {
    const model::Vec3 p(uniform(random), uniform(random), uniform(random));
    const model::Vec3 nearest = p.cwiseMax(box.low).cwiseMin(box.high);
    double expected = (p - nearest).norm();
    if (expected == 0.0) {
      expected = -std::min((p - box.low).minCoeff(), (box.high - p).minCoeff());
      ++inside;
    }
    const Clearance clearance = ClearanceOf(obstacles, 0, p);
    worst = std::max(worst, std::abs(clearance.distance - expected));
    EXPECT_NEAR(clearance.away.norm(), 1.0, 1e-12);
    // A step along `away` increases the distance by its length, inside the box as well.
    const double further = ClearanceOf(obstacles, 0, p + 1e-6 * clearance.away).distance;
    EXPECT_NEAR(further - clearance.distance, 1e-6, 1e-9);
  }
  std::cout << "distances off by " << worst << " m, " << inside << " points inside the box\n";
  EXPECT_LT(worst, 1e-14);
  EXPECT_GT(inside, 100);
}

// Every third segment runs along an axis, every seventh is a point.
TEST(ObstacleTest, SegmentClearanceIsTheSmallestFoundByASearch) {
  config::Obstacles obstacles;
  obstacles.num_boxes = 1;
  obstacles.boxes[0] = {{-0.1, -0.2, 0.0}, {0.3, 0.1, 0.5}};
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-0.8, 0.8);
  constexpr int kPoints = 1000;
  double worst = 0.0;
  int entering = 0;
  for (int n = 0; n < 3000; ++n) {
    const model::Vec3 a(uniform(random), uniform(random), uniform(random));
    model::Vec3 b(uniform(random), uniform(random), uniform(random));
    b = n % 7 == 0 ? a : n % 3 == 0 ? model::Vec3(a + b.x() * model::Vec3::Unit(n % 9 / 3)) : b;
    const SegmentClearance nearest = ClearanceOf(obstacles.boxes[0], a, b);
    ASSERT_TRUE(nearest.s >= 0.0 && nearest.s <= 1.0);
    EXPECT_LT((a + nearest.s * (b - a) - nearest.p_B).norm(), 1e-15);
    EXPECT_EQ(ClearanceOf(obstacles, 0, nearest.p_B).distance, nearest.clearance.distance);
    double least = HUGE_VAL;
    for (int k = 0; k <= kPoints; ++k) {
      least = std::min(least, ClearanceOf(obstacles, 0, a + k / double{kPoints} * (b - a)).distance);
    }
    EXPECT_LT(nearest.clearance.distance, least + 1e-14);
    EXPECT_LT(least - nearest.clearance.distance, 0.5 * (b - a).norm() / kPoints + 1e-14)
        << "the search is not so coarse";
    worst = std::max(worst, least - nearest.clearance.distance);
    entering += nearest.clearance.distance < 0.0 ? 1 : 0;
  }
  std::cout << "the search finds up to " << 1e3 * worst << " mm more; " << entering
            << " segments enter the box\n";
  EXPECT_GT(entering, 200);
}

}  // namespace
}  // namespace fovea::barriers
