// SPDX-License-Identifier: Apache-2.0
// Distance of the arm's links from the line of sight: value against a search, row against differences.
#include "firmware/core/barriers/line_of_sight_barrier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <vector>

#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;
using model::VecN;

// A posture and what follows from it.
struct Posture {
  Posture(const config::ServoConfig& config, const VecN& q) {
    model::ComputePoses(config.arm, q, poses);
    X_BC = poses.X_BE * config.X_EC;
    bodies = PlaceBodies(config.arm, poses);
    model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
  }

  model::ArmPoses poses;
  ArmBodies bodies;
  model::Pose X_BC;
  model::Mat6N J_C;
};

VecN RandomPosture(test::RandomStates& random, const config::ServoConfig& config) {
  return test::Ready() + random.Joints(config.arm, 0.6);
}

// A target near its goal or far to the side, so that links come between.
Vec3 RandomTarget(test::RandomStates& random, const Posture& posture) {
  const Vec3 p_C(random.Uniform(-0.4, 0.4), random.Uniform(-0.4, 0.4), random.Uniform(-0.2, 0.6));
  return posture.X_BC * p_C;
}

const config::Obstacles kNoObstacles;

// A target of one point, or a turned triangle.
Sight SightOf(const Posture& posture, const Vec3& p_BO, bool triangle,
              const config::Obstacles& obstacles = kNoObstacles) {
  Sight sight{posture.poses, posture.bodies, posture.X_BC, {}, {model::RotationOf({0.3, -0.2, 0.9}), p_BO},
              obstacles};
  sight.outline.num_points = triangle ? 3 : 1;
  sight.outline.p_OP[0].setZero();
  if (triangle) {
    sight.outline.p_OP = features::MakeTriangle(features::kDefaultTriangle).corners;
  }
  return sight;
}

config::ServoConfig WithClearance(double clearance) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.sight_clearance = clearance;
  return config;
}

double Clearance(const config::ServoConfig& config, const VecN& q, const Vec3& p_BO, bool triangle) {
  const Posture posture(config, q);
  return ClearanceOfSight(SightOf(posture, p_BO, triangle));
}

// The search tries points on the line of sight and on the links' axes, at most 2 mm apart.
TEST(LineOfSightBarrierTest, ClearanceIsTheSmallestFoundByASearchOverAllLinks) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(71);
  double worst = 0.0;
  for (int k = 0; k < 40; ++k) {
    const Posture posture(config, RandomPosture(random, config));
    const Vec3 p_BO = RandomTarget(random, posture);
    double least = 1e9;
    constexpr int kPoints = 400;
    // The base, and the links of the first four joints; those of the last three carry the camera.
    for (std::size_t i = 0; i <= 4; ++i) {
      const model::Capsule& link = config.arm.shape.bodies[i];
      const Vec3 from = i == 0 ? link.p_LA : posture.poses.X_BL[i - 1] * link.p_LA;
      const Vec3 to = i == 0 ? link.p_LB : posture.poses.X_BL[i - 1] * link.p_LB;
      for (int a = 0; a <= kPoints; ++a) {
        const Vec3 on_link = from + a / double{kPoints} * (to - from);
        for (int b = 0; b <= kPoints; ++b) {
          const Vec3 on_sight = posture.X_BC.p + b / double{kPoints} * (p_BO - posture.X_BC.p);
          least = std::min(least, (on_link - on_sight).norm() - link.radius - 0.02);  // and its housing
        }
      }
    }
    const double clearance = ClearanceOfSight(SightOf(posture, p_BO, false));
    EXPECT_LT(clearance, least + 1e-12);
    worst = std::max(worst, least - clearance);
  }
  std::cout << "the search finds up to " << 1e3 * worst << " mm more\n";
  EXPECT_LT(worst, 0.002);
}

TEST(LineOfSightBarrierTest, RowMatchesFiniteDifferenceOfClearance) {
  const config::ServoConfig config = WithClearance(0.12);
  test::RandomStates random(72);
  double worst = 0.0;
  int beyond = 0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = RandomPosture(random, config);
    const Posture posture(config, q);
    const Vec3 p_BO = RandomTarget(random, posture);
    const bool triangle = k % 2 == 0;
    MotionLimits limits;
    limits.Add(LineOfSightBarrier(config, SightOf(posture, p_BO, triangle), posture.J_C));
    ASSERT_EQ(limits.num_rows, 1);
    const double clearance = Clearance(config, q, p_BO, triangle);
    EXPECT_NEAR(limits.rows[0].b, 1.5 * std::max(clearance - 0.12, 0.0), 1e-12);
    beyond += clearance < 0.12 ? 1 : 0;
    const VecN dq = random.Joints(config.arm, 0.5);
    constexpr double kDt = 1e-6;
    const double rate =
        (Clearance(config, q + kDt * dq, p_BO, triangle) - Clearance(config, q - kDt * dq, p_BO, triangle)) /
        (2.0 * kDt);
    worst = std::max(worst, std::abs(limits.rows[0].a.dot(dq) + rate));
  }
  std::cout << "off by at most " << worst << " m/s; " << beyond << " of 300 below the clearance\n";
  EXPECT_LT(worst, 1e-7);
  EXPECT_GT(beyond, 20);
}

// A box somewhere between camera and target, or beside them.
config::Obstacles BoxNear(test::RandomStates& random, const Posture& posture, const Vec3& p_BO) {
  config::Obstacles obstacles;
  obstacles.num_planes = 1;  // planes do not count
  obstacles.num_boxes = 1;
  const Vec3 middle =
      0.5 * (posture.X_BC.p + p_BO) + random.Joints(test::PandaConfig().arm, 1.0).head<3>() * 0.1;
  const Vec3 half(0.03, 0.05, 0.04);
  obstacles.boxes[0] = {middle - half, middle + half};
  return obstacles;
}

// The last tenth of a line does not count.
TEST(LineOfSightBarrierTest, BoxesKeepOutOfTheLinesOfSightBeforeTheTarget) {
  config::ServoConfig config = WithClearance(0.12);
  test::RandomStates random(73);
  double worst_search = 0.0;
  double worst_rate = 0.0;
  int boxes = 0;
  int hidden = 0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = RandomPosture(random, config);
    const Posture posture(config, q);
    const Vec3 p_BO = RandomTarget(random, posture);
    config.guard.obstacles = BoxNear(random, posture, p_BO);
    const config::Obstacles& obstacles = config.guard.obstacles;
    const double alone = ClearanceOfSight(SightOf(posture, p_BO, false));
    double least = alone;
    constexpr int kPoints = 1000;
    for (int i = 0; i <= kPoints; ++i) {
      const Vec3 p = posture.X_BC.p + i * 0.9 / kPoints * (p_BO - posture.X_BC.p);
      least = std::min(least, ClearanceOf(obstacles, 1, p).distance);
    }
    const auto clearance = [&](const VecN& at) {
      const Posture there(config, at);
      return ClearanceOfSight(SightOf(there, p_BO, false, obstacles));
    };
    const double gap = clearance(q);
    EXPECT_LT(gap, least + 1e-12);
    EXPECT_LT(least - gap, 0.45 * (p_BO - posture.X_BC.p).norm() / kPoints + 1e-12)
        << "the search is not so coarse";
    worst_search = std::max(worst_search, least - gap);
    if (gap == alone) {
      continue;
    }
    ++boxes;
    if (gap < 0.0) {  // the nearest face may change from one side of the difference to the other
      ++hidden;
      continue;
    }
    MotionLimits limits;
    limits.Add(LineOfSightBarrier(config, SightOf(posture, p_BO, false, obstacles), posture.J_C));
    ASSERT_EQ(limits.num_rows, 1);
    const VecN dq = random.Joints(config.arm, 0.5);
    constexpr double kDt = 1e-6;
    const double rate = (clearance(q + kDt * dq) - clearance(q - kDt * dq)) / (2.0 * kDt);
    worst_rate = std::max(worst_rate, std::abs(limits.rows[0].a.dot(dq) + rate));
  }
  std::cout << boxes << " of 300 boxes are nearer than links, " << hidden
            << " hide the target; the search finds up to " << 1e3 * worst_search
            << " mm more, rows are off by at most " << worst_rate << " m/s\n";
  EXPECT_LT(worst_rate, 1e-6);
  EXPECT_GT(boxes, 100);
  EXPECT_GT(hidden, 10);
}

TEST(LineOfSightBarrierTest, NoRowWithoutAClearanceLimitOrWhereTheLinesCross) {
  const config::ServoConfig config = WithClearance(0.12);
  const Posture posture(config, test::Ready());
  const Vec3 ahead = posture.X_BC * Vec3(0.0, 0.0, 0.4);
  MotionLimits limits;
  limits.Add(LineOfSightBarrier(WithClearance(0.0), SightOf(posture, ahead, true), posture.J_C));
  EXPECT_EQ(limits.num_rows, 0);
  limits.Add(LineOfSightBarrier(config, SightOf(posture, posture.bodies.body[3].middle, false), posture.J_C));
  EXPECT_EQ(limits.num_rows, 0);
  limits.Add(LineOfSightBarrier(config, SightOf(posture, ahead * std::nan(""), true), posture.J_C));
  EXPECT_EQ(limits.num_rows, 0);
}

}  // namespace
}  // namespace fovea::barriers
