// SPDX-License-Identifier: Apache-2.0
// Distance of the arm from itself and from planes: values against a search, rows against differences.
#include "firmware/core/barriers/self_clearance_barrier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/barriers/links_barrier.hpp"
#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;
using model::VecN;

const model::ArmModel& Arm() { return test::Panda().model; }

model::ArmPoses PosesAt(const VecN& q) {
  model::ArmPoses poses;
  model::ComputePoses(Arm(), q, poses);
  return poses;
}

ArmBodies BodiesAt(const VecN& q) { return PlaceBodies(Arm(), PosesAt(q)); }

double Gap(const VecN& q) { return SelfClearance(Arm(), BodiesAt(q)); }

// A table, and a wall that leans over it.
config::GuardConfig Planes() {
  config::GuardConfig guard;
  guard.link_clearance = 0.05;
  config::Obstacles& obstacles = guard.obstacles;
  obstacles.num_planes = 2;
  obstacles.planes[0] = {Vec3(0.0, 0.0, 1.0), 0.1};
  obstacles.planes[1] = {Vec3(-0.6, 0.0, -0.8), -0.7};
  return guard;
}

config::ServoConfig WithPlanes() {
  config::ServoConfig config = test::PandaConfig();
  config.guard = Planes();
  return config;
}

config::ServoConfig WithSelfClearance(double clearance) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.self_clearance = clearance;
  return config;
}

double PlaneClearance(const VecN& q) {
  return ClearanceOfLinks(Planes().obstacles, 0, BodiesAt(q), HUGE_VAL);
}

// The search tries points on the two axes of each pair, at most 1 mm apart.
TEST(SelfClearanceBarrierTest, GapIsTheSmallestFoundByASearchOverAllPairs) {
  test::RandomStates random(81);
  const model::ArmShape& shape = Arm().shape;
  ASSERT_GT(shape.num_pairs, 5);
  double worst = 0.0;
  for (int k = 0; k < 60; ++k) {
    const VecN q = random.Position(Arm());
    const model::ArmPoses poses = PosesAt(q);
    const auto on_axis = [&](int body, double share) -> Vec3 {
      const model::Capsule& capsule = shape.bodies[static_cast<std::size_t>(body)];
      const Vec3 p_L = capsule.p_LA + share * (capsule.p_LB - capsule.p_LA);
      return body == 0 ? p_L : Vec3(poses.X_BL[static_cast<std::size_t>(body - 1)] * p_L);
    };
    double least = 1e9;
    constexpr int kPoints = 200;
    for (std::size_t i = 0; i < static_cast<std::size_t>(shape.num_pairs); ++i) {
      const auto [near, far] = shape.pairs[i];
      const double radii = shape.bodies[static_cast<std::size_t>(near)].radius +
                           shape.bodies[static_cast<std::size_t>(far)].radius;
      for (int a = 0; a <= kPoints; ++a) {
        for (int b = 0; b <= kPoints; ++b) {
          const double distance =
              (on_axis(near, a / double{kPoints}) - on_axis(far, b / double{kPoints})).norm();
          least = std::min(least, distance - radii);
        }
      }
    }
    const double gap = Gap(q);
    EXPECT_LT(gap, least + 1e-12);
    worst = std::max(worst, least - gap);
  }
  std::cout << "the search finds up to " << 1e3 * worst << " mm more\n";
  EXPECT_LT(worst, 0.002);
}

// The search tries points on the axes of the last four links, and subtracts the radius.
TEST(LinksBarrierTest, ClearanceIsTheSmallestFoundByASearchOverAllLinks) {
  test::RandomStates random(82);
  for (int k = 0; k < 300; ++k) {
    const VecN q = random.Position(Arm());
    const model::ArmPoses poses = PosesAt(q);
    double least = 1e9;
    constexpr int kPoints = 50;
    for (std::size_t i = 3; i < 7; ++i) {
      const model::Capsule& capsule = Arm().shape.bodies[i + 1];
      for (int a = 0; a <= kPoints; ++a) {
        const Vec3 p = poses.X_BL[i] * (capsule.p_LA + a / double{kPoints} * (capsule.p_LB - capsule.p_LA));
        least =
            std::min({least, p.z() - 0.1 - capsule.radius, 0.7 - 0.6 * p.x() - 0.8 * p.z() - capsule.radius});
      }
    }
    EXPECT_NEAR(PlaneClearance(q), least, 1e-12);
  }
}

// As above, with all links that move, and a box. A limit on what is asked for changes nothing below it.
TEST(LinksBarrierTest, ClearanceOfABoxIsTheSmallestOfAllLinksUpToWhatIsEnough) {
  test::RandomStates random(84);
  config::Obstacles obstacles;
  obstacles.num_boxes = 1;
  int near = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 low(random.Uniform(-0.6, 0.6), random.Uniform(-0.6, 0.6), random.Uniform(-0.2, 0.8));
    const config::Box& box = obstacles.boxes[0] = {low, low + Vec3(0.3, 0.2, 0.25)};
    const ArmBodies bodies = BodiesAt(random.Position(Arm()));
    double least = HUGE_VAL;
    for (int body = 1; body < bodies.size; ++body) {
      const PlacedCapsule& capsule = bodies.body[static_cast<std::size_t>(body)];
      least =
          std::min(least, ClearanceOf(box, capsule.p_BA, capsule.p_BB).clearance.distance - capsule.radius);
    }
    EXPECT_DOUBLE_EQ(ClearanceOfLinks(obstacles, 0, bodies, HUGE_VAL), least);
    const double enough = 0.1;
    EXPECT_DOUBLE_EQ(ClearanceOfLinks(obstacles, 0, bodies, enough), std::min(least, enough));
    near += least < enough ? 1 : 0;
  }
  EXPECT_GT(near, 50);
  EXPECT_LT(near, 250);
}

// Compares the row of `limits` with the finite difference of `clearance`.
template <class Clearance>
void ExpectRow(const MotionLimits& limits, const VecN& q, const VecN& dq, const Clearance& clearance,
               double& worst) {
  ASSERT_EQ(limits.num_rows, 1);
  constexpr double kDt = 1e-6;
  const double rate = (clearance(q + kDt * dq) - clearance(q - kDt * dq)) / (2.0 * kDt);
  worst = std::max(worst, std::abs(limits.rows[0].a.dot(dq) + rate));
}

TEST(SelfClearanceBarrierTest, GradientMatchesFiniteDifferenceOfClearance) {
  test::RandomStates random(83);
  double worst_self = 0.0;
  double worst_arm = 0.0;
  int selves = 0;
  int arms = 0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = random.Position(Arm());
    const VecN dq = random.Joints(Arm(), 0.5);
    MotionLimits self;
    self.Add(SelfClearanceBarrier(WithSelfClearance(0.2), PosesAt(q), BodiesAt(q)));
    ExpectRow(self, q, dq, Gap, worst_self);
    EXPECT_NEAR(self.rows[0].b, 1.5 * std::max(Gap(q) - 0.2, 0.0), 1e-12);
    MotionLimits arm;
    arm.Add(LinksBarrier(WithPlanes(), 0, PosesAt(q), BodiesAt(q)));
    ExpectRow(arm, q, dq, PlaneClearance, worst_arm);
    EXPECT_NEAR(arm.rows[0].b,
                BarrierSpeed(PlaneClearance(q) - 0.05 - 2.0 * WithPlanes().guard.workspace_margin,
                             0.5 * WithPlanes().guard.workspace_deceleration,
                             trajectory::SlowestReaction(WithPlanes())),
                1e-12);
    selves += Gap(q) < 0.2 ? 1 : 0;
    arms += PlaneClearance(q) < 0.05 ? 1 : 0;
  }
  std::cout << "off by at most " << worst_self << ", " << worst_arm << " m/s; " << selves << " and " << arms
            << " of 300 below the clearance\n";
  EXPECT_LT(worst_self, 1e-7);
  EXPECT_LT(worst_arm, 1e-7);
  EXPECT_GT(selves, 20);
  EXPECT_GT(arms, 20);
}

TEST(SelfClearanceBarrierTest, NoRowWithoutAClearanceLimitOrKnownGeometry) {
  MotionLimits limits;
  const VecN q = test::Ready();
  limits.Add(SelfClearanceBarrier(WithSelfClearance(0.0), PosesAt(q), BodiesAt(q)));
  EXPECT_EQ(CountLinkRows(test::PandaConfig().guard.obstacles), 0);
  const VecN nowhere = q * std::nan("");
  limits.Add(SelfClearanceBarrier(WithSelfClearance(0.13), PosesAt(nowhere), BodiesAt(nowhere)));
  limits.Add(LinksBarrier(WithPlanes(), 0, PosesAt(nowhere), BodiesAt(nowhere)));
  EXPECT_EQ(limits.num_rows, 0);
  model::ArmModel without_pairs = Arm();
  without_pairs.shape.num_pairs = 0;
  EXPECT_EQ(SelfClearance(without_pairs, BodiesAt(q)), HUGE_VAL);
}

}  // namespace
}  // namespace fovea::barriers
