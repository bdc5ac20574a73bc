// SPDX-License-Identifier: Apache-2.0
// Contacts of links with each other and with the target, which physics lets pass.
#include "sim/physics/link_touch.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <iostream>

#include "sim/panda/self_distance.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::sim {
namespace {

Shape Ball(double radius) {
  Shape shape;
  shape.kind = ShapeKind::kSphere;
  shape.size = {radius, 0.0, 0.0};
  return shape;
}

class LinkTouchTest : public testing::Test {
 protected:
  LinkTouchTest()
      : robot_(LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange")),
        arm_(robot_, {}) {}

  std::vector<Eigen::Isometry3d> Poses(const Eigen::VectorXd& q) {
    arm_.SetState(q, Eigen::VectorXd::Zero(7));
    std::vector<Eigen::Isometry3d> X_BL;
    for (int i = 0; i < static_cast<int>(robot_.links.size()); ++i) {
      X_BL.push_back(arm_.LinkPose(i));
    }
    return X_BL;
  }

  SimRobot robot_;
  BulletArm arm_;
};

// For capsules the result must agree with their distance.
TEST_F(LinkTouchTest, LinksOverlapWhereTheirCapsulesDo) {
  LinkTouch touch(robot_, std::nullopt);
  const SelfDistance distance(robot_);
  test::RandomStates random(7);
  int touching = 0;
  int near = 0;
  for (int k = 0; k < 3000; ++k) {
    const std::vector<Eigen::Isometry3d> X_BL = Poses(random.Position(test::Panda().model));
    const double gap = distance.Least(X_BL);
    if (std::abs(gap) < 1e-6) {
      continue;
    }
    touch.Place(X_BL, Eigen::Isometry3d::Identity());
    EXPECT_EQ(touch.Self(), gap < 0.0) << gap << " m";
    EXPECT_FALSE(touch.Target()) << "there is no target";
    touching += gap < 0.0 ? 1 : 0;
    near += gap >= 0.0 && gap < 0.05 ? 1 : 0;
  }
  std::cout << touching << " of 3000 random postures collide with themselves, " << near
            << " have a gap below 50 mm\n";
  EXPECT_GT(touching, 30);
  EXPECT_GT(near, 30);
}

TEST_F(LinkTouchTest, AnyLinkCanTouchTheTarget) {
  constexpr double kRadius = 0.04;
  LinkTouch touch(robot_, Ball(kRadius));
  const std::vector<Eigen::Isometry3d> X_BL = Poses(test::Ready());
  // Beside the forearm's capsule: from its centre outwards along its own x.
  std::size_t forearm = 0;
  for (std::size_t k = 0; k < robot_.links.size(); ++k) {
    forearm = robot_.links[k].name == "panda_link5" ? k : forearm;
  }
  const Shape& capsule = robot_.links[forearm].collisions.at(0);
  const auto at = [&](double off) {
    Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
    X_BO.translation() = X_BL[forearm] * (capsule.X_LS * Eigen::Vector3d(off, 0.0, 0.0));
    touch.Place(X_BL, X_BO);
    return touch.Target();
  };
  const double reach = capsule.size[0] + kRadius;
  EXPECT_TRUE(at(reach - 1e-4));
  EXPECT_FALSE(at(reach + 1e-4));
  EXPECT_FALSE(touch.Self());
}

TEST_F(LinkTouchTest, PrintsItsCostBesideAStepOfPhysics) {
  LinkTouch touch(robot_, Ball(0.04));
  const std::vector<Eigen::Isometry3d> X_BL = Poses(test::Ready());
  const auto us = [](auto work) {
    constexpr int kTimes = 2000;
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < kTimes; ++k) {
      work();
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    return took.count() / kTimes;
  };
  bool any = false;
  const double looking = us([&] {
    touch.Place(X_BL, Eigen::Isometry3d::Identity());
    any = touch.Self() || touch.Target() || any;
  });
  const double step = us([&] { arm_.Step(Eigen::VectorXd::Zero(7), 1e-3); });
  std::cout << "the contact check takes " << looking << " us, a step of physics " << step << " us\n";
}

}  // namespace
}  // namespace fovea::sim
