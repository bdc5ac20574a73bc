// The arm beside itself and above planes: distances against a search, rows against differences.
#include "firmware/core/barriers/self_clearance_barrier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <vector>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/barriers/links_barrier.hpp"
#include "firmware/core/barriers/motion_limits.hpp"
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

ArmLine LineAt(const VecN& q) { return LineOfArm(Arm(), PosesAt(q)); }

double HandClearance(const VecN& q) { return ClearanceOfHand(Arm(), LineAt(q)); }

// A table, and a wall that leans over it.
config::GuardConfig Planes() {
  config::GuardConfig guard;
  guard.link_radius = 0.05;
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

config::ServoConfig WithHandClearance(double clearance) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.hand_clearance = clearance;
  return config;
}

double PlaneClearance(const VecN& q) { return ClearanceOfPlanes(Arm(), Planes(), LineAt(q)); }

// Points on the two lines, 2 mm apart and less.
TEST(SelfClearanceBarrierTest, HandClearanceIsTheSmallestDistanceBetweenTheLines) {
  test::RandomStates random(81);
  double worst = 0.0;
  for (int k = 0; k < 60; ++k) {
    const VecN q = random.Position(Arm());
    const model::ArmPoses poses = PosesAt(q);
    const std::vector<Vec3> trunk{Vec3::Zero(), poses.X_BL[0].p, poses.X_BL[1].p, poses.X_BL[2].p};
    double least = 1e9;
    constexpr int kPoints = 400;
    for (std::size_t i = 0; i + 1 < trunk.size(); ++i) {
      for (int a = 0; a <= kPoints; ++a) {
        const Vec3 on_trunk = trunk[i] + a / double{kPoints} * (trunk[i + 1] - trunk[i]);
        for (int b = 0; b <= kPoints; ++b) {
          const Vec3 on_hand = poses.X_BL[6].p + b / double{kPoints} * (poses.X_BE.p - poses.X_BL[6].p);
          least = std::min(least, (on_hand - on_trunk).norm() - (i == 0 ? 0.02 : 0.0));  // a thicker base
        }
      }
    }
    // The forearm, from the elbow on, against the base's column; both are thicker, by 5 cm.
    const std::vector<Vec3> forearm{
        poses.X_BL[3].p, poses.X_BL[3] * Vec3(-0.0825, 0.0, 0.0), poses.X_BL[4].p,
        poses.X_BL[5].p, poses.X_BL[5] * Vec3(0.088, 0.0, 0.0),   poses.X_BL[6].p};
    for (std::size_t i = 0; i + 1 < forearm.size(); ++i) {
      for (int a = 0; a <= kPoints; ++a) {
        const Vec3 on_arm = forearm[i] + a / double{kPoints} * (forearm[i + 1] - forearm[i]);
        for (int b = 0; b <= kPoints; ++b) {
          const Vec3 on_base = b / double{kPoints} * poses.X_BL[0].p;
          least = std::min(least, (on_arm - on_base).norm() - 0.05);
        }
      }
    }
    const double clearance = HandClearance(q);
    EXPECT_LT(clearance, least + 1e-12);
    worst = std::max(worst, least - clearance);
  }
  std::cout << "the search finds up to " << 1e3 * worst << " mm more\n";
  EXPECT_LT(worst, 0.002);
}

TEST(SelfClearanceBarrierTest, ArmClearanceIsThatOfItsLowestPointFromTheElbowOn) {
  test::RandomStates random(82);
  for (int k = 0; k < 300; ++k) {
    const VecN q = random.Position(Arm());
    const model::ArmPoses poses = PosesAt(q);
    std::vector<Vec3> points{poses.X_BL[3] * Vec3(-0.0825, 0.0, 0.0)};
    for (std::size_t i = 3; i < 7; ++i) {
      points.push_back(poses.X_BL[i].p);
    }
    double least = 1e9;
    for (const Vec3& p : points) {
      least = std::min({least, p.z() - 0.1, 0.7 - 0.6 * p.x() - 0.8 * p.z()});
    }
    EXPECT_NEAR(PlaneClearance(q), least - Planes().link_radius, 1e-12);
  }
}

// The row of `limits` against the change of `clearance` with the joints.
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
  double worst_hand = 0.0;
  double worst_arm = 0.0;
  int hands = 0;
  int arms = 0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = random.Position(Arm());
    const VecN dq = random.Joints(Arm(), 0.5);
    MotionLimits hand;
    hand.Add(SelfClearanceBarrier(WithHandClearance(0.3), PosesAt(q), LineAt(q)));
    ExpectRow(hand, q, dq, HandClearance, worst_hand);
    EXPECT_NEAR(hand.rows[0].b, 1.5 * std::max(HandClearance(q) - 0.3, 0.0), 1e-12);
    MotionLimits arm;
    arm.Add(LinksBarrier(WithPlanes(), PosesAt(q), LineAt(q)));
    ExpectRow(arm, q, dq, PlaneClearance, worst_arm);
    EXPECT_EQ(arm.rows[0].b, BarrierSpeed(PlaneClearance(q) - 2.0 * WithPlanes().guard.workspace_margin,
                                          0.5 * WithPlanes().guard.workspace_deceleration,
                                          trajectory::SlowestReaction(WithPlanes())));
    hands += HandClearance(q) < 0.3 ? 1 : 0;
    arms += PlaneClearance(q) < 0.0 ? 1 : 0;
  }
  std::cout << "off by at most " << worst_hand << ", " << worst_arm << " m/s; " << hands << " and " << arms
            << " of 300 nearer than they shall be\n";
  EXPECT_LT(worst_hand, 1e-7);
  EXPECT_LT(worst_arm, 1e-7);
  EXPECT_GT(hands, 20);
  EXPECT_GT(arms, 20);
}

TEST(SelfClearanceBarrierTest, NoRowWithoutAClearanceLimitOrKnownGeometry) {
  MotionLimits limits;
  const VecN q = test::Ready();
  limits.Add(SelfClearanceBarrier(WithHandClearance(0.0), PosesAt(q), LineAt(q)));
  limits.Add(LinksBarrier(test::PandaConfig(), PosesAt(q), LineAt(q)));
  limits.Add(
      SelfClearanceBarrier(WithHandClearance(0.13), PosesAt(q * std::nan("")), LineAt(q * std::nan(""))));
  limits.Add(LinksBarrier(WithPlanes(), PosesAt(q * std::nan("")), LineAt(q * std::nan(""))));
  EXPECT_EQ(limits.num_rows, 0);
  model::ArmModel short_arm = Arm();
  short_arm.num_joints = 5;
  EXPECT_EQ(ClearanceOfHand(short_arm, LineAt(q)), HUGE_VAL);
}

}  // namespace
}  // namespace fovea::barriers
