// SPDX-License-Identifier: Apache-2.0
// The link frames in the log match the physics.
#include "sim/run/log_scene.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <set>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/robots/robot.hpp"
#include "foxglove/scene.pb.h"
#include "sim/physics/bullet_arm.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

const Eigen::Isometry3d kMount =
    Eigen::Translation3d(0.05, 0.0, 0.04) * Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ());

class LogSceneTest : public testing::TestWithParam<const char*> {};

TEST_P(LogSceneTest, EveryLinkMatchesItsPhysicsPose) {
  const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/" + GetParam() + ".toml");
  const SimRobot sim_robot = LoadSimRobot(robot.urdf, robot.base_link, robot.tip_link);
  const std::vector<log::LinkFrame> frames = MakeLinkFrames(sim_robot, robot.model, kMount);
  ASSERT_EQ(frames.size(), sim_robot.links.size() + 1) << "all links, and the camera";
  BulletArm arm(sim_robot, {.integrator = Integrator::kSemiImplicitEuler, .table = false, .gravity = false});
  test::RandomStates random(3);
  double worst = 0.0;
  for (int n = 0; n < 100; ++n) {
    const model::VecN q = random.Position(robot.model);
    model::ArmPoses poses;
    model::ComputePoses(robot.model, q, poses);
    arm.SetState(q, Eigen::VectorXd::Zero(q.size()));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const model::Pose X_BL = frames[i].joint < 0
                                   ? frames[i].X_LnF
                                   : poses.X_BL[static_cast<std::size_t>(frames[i].joint)] * frames[i].X_LnF;
      const bool is_camera = i == sim_robot.links.size();
      const Eigen::Isometry3d truth =
          is_camera ? arm.LinkPose(sim_robot.tip) * kMount : arm.LinkPose(static_cast<int>(i));
      worst = std::max({worst, (X_BL.p - truth.translation()).norm(), (X_BL.R - truth.linear()).norm()});
    }
  }
  std::cout << GetParam() << ": frames of the log and links of the physics differ by " << worst << " m, 1\n";
  EXPECT_LT(worst, 1e-9);
}
INSTANTIATE_TEST_SUITE_P(Arms, LogSceneTest, testing::Values("panda", "ur5e", "puma560", "gantry"),
                         [](const auto& arm) { return std::string(arm.param); });

// The target's frame includes a plate's orientation, so the plate is not turned a second time. A disc's frame
// does not, so the shape has the scenario's orientation.
TEST(LogSceneTargetTest, PlateIsTurnedOnlyByItsFrame) {
  RenderScene scene;
  scene.target_R_BO = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const auto target_of = [&scene] {
    const foxglove::SceneUpdate update = MakeSceneMessage(scene);
    const foxglove::SceneEntity& entity = update.entities(update.entities_size() - 1);
    EXPECT_EQ(entity.frame_id(), log::kTargetFrame);
    return entity;
  };
  scene.target.kind = TargetShape::Kind::kPolygon;
  scene.target.corners = {{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  const foxglove::SceneEntity plate = target_of();
  ASSERT_EQ(plate.triangles_size(), 1);
  EXPECT_EQ(plate.triangles(0).pose().orientation().w(), 1.0);
  EXPECT_EQ(plate.triangles(0).points_size(), 4);
  scene.target = {TargetShape::Kind::kDisc, 0.04, {}};
  const foxglove::SceneEntity disc = target_of();
  ASSERT_EQ(disc.cylinders_size(), 1);
  EXPECT_NEAR(disc.cylinders(0).pose().orientation().x(), std::sin(0.35), 1e-12);
}

// Link names may look like our own frame names.
TEST(LogSceneNamesTest, LinkNamesDoNotCollideWithOurFrames) {
  const test::TempFolder folder;
  const auto urdf = folder.path() / "arm.urdf";
  std::ofstream(urdf)
      << R"(<robot name="two"><link name="base"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
    <joint name="a" type="prismatic"><parent link="base"/><child link="camera"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" velocity="2" effort="10"/></joint>
    <link name="camera"><inertial><mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
      <visual><geometry><sphere radius="0.1"/></geometry></visual></link></robot>)";
  const robots::Robot robot = robots::LoadRobot(urdf);
  RenderScene scene;
  scene.robot = LoadSimRobot(urdf, "base", "camera");
  std::set<std::string> frames{log::kBaseFrame, log::kTargetFrame};
  for (const log::LinkFrame& frame : MakeLinkFrames(scene.robot, robot.model, kMount)) {
    EXPECT_TRUE(frames.insert(frame.name).second) << frame.name << " exists twice";
  }
  EXPECT_EQ(frames.size(), 5U);
  const foxglove::SceneUpdate update = MakeSceneMessage(scene);
  for (const foxglove::SceneEntity& entity : update.entities()) {
    EXPECT_EQ(frames.count(entity.frame_id()), 1U) << entity.id() << " in " << entity.frame_id();
  }
}

}  // namespace
}  // namespace fovea::sim
