// SPDX-License-Identifier: Apache-2.0
// Which lines of sight the drawn arm cuts: compared with points every millimetre along them.
#include "tools/fovea/atlas/drawn_arm.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "sim/robot/chain.hpp"
#include "tests/support/panda.hpp"
#include "tools/fovea/atlas/uniform.hpp"

namespace fovea::atlas {
namespace {

using Eigen::Vector3d;

// Whether a point in the solid's frame is inside, or at most `beyond` outside of, the solid.
bool IsIn(const sim::Shape& shape, const Vector3d& p, double beyond) {
  switch (shape.kind) {
    case sim::ShapeKind::kBox: return ((p.cwiseAbs() - 0.5 * shape.size).array() <= beyond).all();
    case sim::ShapeKind::kCylinder:
      return p.head<2>().norm() <= shape.size.x() + beyond &&
             std::fabs(p.z()) <= 0.5 * shape.size.y() + beyond;
    default: return p.norm() <= shape.size.x() + beyond;
  }
}

class DrawnArmTest : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Arms, DrawnArmTest, testing::Values("panda", "ur5e", "gantry"));

TEST_P(DrawnArmTest, HidesWhatItsSolidsHide) {
  constexpr int kLines = 2000;
  constexpr double kStep = 0.001;  // [m]
  const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/" + GetParam() + ".toml");
  const DrawnArm drawn(robot);
  const sim::SimRobot arm = sim::LoadSimRobot(robot.urdf, robot.base_link, robot.tip_link);
  const sim::Chain chain(arm);
  // The last link moves with the camera, and all links fixed to it.
  std::vector<bool> counts(arm.links.size());
  for (std::size_t i = 0; i < arm.links.size(); ++i) {
    const sim::SimLink& link = arm.links[i];
    counts[i] =
        link.dof != arm.num_dofs - 1 && (link.parent < 0 || counts[static_cast<std::size_t>(link.parent)]);
  }
  std::mt19937_64 engine(1);
  int hidden = 0;
  for (int line = 0; line < kLines; ++line) {
    model::VecN q(robot.model.num_joints);
    for (int i = 0; i < q.size(); ++i) {
      const model::Joint& joint = robot.model.joints[static_cast<std::size_t>(i)];
      q[i] = Uniform(engine, joint.q_min, joint.q_max);
    }
    const auto point = [&] {
      return Vector3d(Uniform(engine, -0.8, 0.8), Uniform(engine, -0.8, 0.8), Uniform(engine, 0.0, 1.0));
    };
    const Vector3d a = point();
    const Vector3d b = point();
    const std::vector<Eigen::Isometry3d> X_BL = chain.LinkPoses(q);
    bool inside = false;
    bool near = false;
    const int steps = static_cast<int>((b - a).norm() / kStep);
    for (std::size_t i = 0; i < arm.links.size(); ++i) {
      for (const sim::Shape& shape : arm.links[i].visuals) {
        const Eigen::Isometry3d X_SB = (X_BL[i] * shape.X_LS).inverse();
        for (int k = 0; counts[i] && k <= steps; ++k) {
          const Vector3d p = X_SB * (a + static_cast<double>(k) / steps * (b - a));
          inside = inside || IsIn(shape, p, 0.0);
          near = near || IsIn(shape, p, kStep);
        }
      }
    }
    const bool hides = drawn.Hides(q, a, {b});
    hidden += hides ? 1 : 0;
    EXPECT_TRUE(hides || !inside) << "line " << line;
    EXPECT_TRUE(!hides || near) << "line " << line;
  }
  std::cout << GetParam() << " hides " << hidden << " of " << kLines << " lines\n";
  EXPECT_GT(hidden, 10);
  EXPECT_LT(hidden, kLines / 2);
}

}  // namespace
}  // namespace fovea::atlas
