// SPDX-License-Identifier: Apache-2.0
// The distance between an arm's links, compared with hand computations.
#include "sim/panda/self_distance.hpp"

#include <gtest/gtest.h>

#include "tests/sim/panda/wire_panda.hpp"

namespace fovea::test {
namespace {

sim::SimLink Link(int parent, int dof, double half_length, double radius) {
  sim::SimLink link;
  link.parent = parent;
  link.joint = dof >= 0 ? sim::SimJointKind::kRevolute : sim::SimJointKind::kFixed;
  link.dof = dof;
  sim::Shape shape;
  shape.kind = half_length > 0.0 ? sim::ShapeKind::kCylinder : sim::ShapeKind::kSphere;
  shape.size = {radius, 2.0 * half_length, 0.0};
  link.collisions.push_back(shape);
  return link;
}

// Base and third link; the two links between have no shape.
sim::SimRobot Two(const sim::SimLink& base, const sim::SimLink& third) {
  sim::SimRobot robot;
  sim::SimLink between = Link(0, 0, 0.0, 0.0);
  between.collisions.clear();
  robot.links = {base, between, between, third};
  robot.links[2].parent = 1;
  robot.links[2].dof = 1;
  robot.num_dofs = 3;
  return robot;
}

double Least(const sim::SimRobot& robot, const Eigen::Isometry3d& X_BThird) {
  std::vector<Eigen::Isometry3d> X_BL(4, Eigen::Isometry3d::Identity());
  X_BL[3] = X_BThird;
  return sim::SelfDistance(robot).Least(X_BL);
}

TEST(SelfDistance, CapsuleDistanceMatchesGeometry) {
  const sim::SimRobot robot = Two(Link(-1, -1, 0.5, 0.1), Link(2, 2, 0.3, 0.05));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_NEAR(Least(robot, X), 0.85, 1e-12) << "side by side";
  X.translation() = Eigen::Vector3d(0.0, 0.0, 2.0);
  EXPECT_NEAR(Least(robot, X), 2.0 - 0.5 - 0.3 - 0.15, 1e-12) << "end to end";
  X.translation() = Eigen::Vector3d(0.2, 0.0, 0.4);
  X.linear() = Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NEAR(Least(robot, X), 0.05, 1e-12) << "crossed";
  X.translation() = Eigen::Vector3d(0.3, 0.0, 0.9);
  EXPECT_NEAR(Least(robot, X), 0.5 - 0.15, 1e-12) << "crossed, past an end: a triangle of 3, 4 and 5";
  X.translation() = Eigen::Vector3d(0.0, 0.7, 0.5);
  EXPECT_NEAR(Least(robot, X), 0.4 - 0.15, 1e-12) << "an end at an end";
}

TEST(SelfDistance, CapsuleOfZeroLengthIsASphere) {
  const sim::SimRobot robot = Two(Link(-1, -1, 0.0, 0.1), Link(2, 2, 0.0, 0.2));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(0.3, 0.0, 0.4);
  EXPECT_NEAR(Least(robot, X), 0.2, 1e-12);
}

TEST(SelfDistance, NeighbouringLinksAreIgnored) {
  sim::SimRobot robot = Two(Link(-1, -1, 0.5, 0.1), Link(2, 2, 0.3, 0.05));
  robot.links[3].parent = 1;  // one link less in between
  EXPECT_TRUE(std::isinf(Least(robot, Eigen::Isometry3d::Identity())));
}

TEST(SelfDistance, PandaInItsReadyPostureIsFarFromItself) {
  const sim::WorldConfig config = WirePandaWorld();
  const sim::Chain chain(config.robot);
  const double gap = sim::SelfDistance(config.robot).Least(chain.LinkPoses(config.q_start));
  std::cout << gap << " m\n";
  EXPECT_GT(gap, 0.1);
}

}  // namespace
}  // namespace fovea::test
