// SPDX-License-Identifier: Apache-2.0
// Robots from files: what is read, and the error of each refusal.
#include "firmware/host/robots/robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <sstream>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/config/input_error.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::robots {
namespace {

using testing::HasSubstr;

TEST(RobotTest, ReadsThePanda) {
  const Robot& panda = test::Panda();
  EXPECT_EQ(panda.name, "panda");
  EXPECT_EQ(panda.base_link, "panda_base");
  EXPECT_EQ(panda.tip_link, "panda_flange");
  ASSERT_EQ(panda.model.num_joints, 7);
  EXPECT_EQ(panda.joint_names[6], "panda_joint7");
  // The manufacturer's figures: joint 4's range, joint 7's torque, joint 2's acceleration.
  EXPECT_EQ(panda.model.joints[3].q_min, -3.0718);
  EXPECT_EQ(panda.model.joints[3].q_max, -0.0698);
  EXPECT_EQ(panda.model.joints[6].tau_max, 12.0);
  EXPECT_EQ(panda.model.joints[1].ddq_max, 7.5);
  EXPECT_EQ(panda.model.joints[1].dtau_max, 1000.0);
  EXPECT_EQ(panda.model.links[6].mass, 0.735522);
  // The ready pose: flange 0.307 m in front of the base, 0.590 m up, pointing down.
  model::ArmPoses poses;
  model::ComputePoses(panda.model, test::Ready(), poses);
  EXPECT_NEAR(poses.X_BE.p.x(), 0.3069, 1e-3);
  EXPECT_NEAR(poses.X_BE.p.y(), 0.0, 1e-9);
  EXPECT_NEAR(poses.X_BE.p.z(), 0.5903, 1e-3);
  EXPECT_NEAR(poses.X_BE.R(2, 2), -1.0, 1e-9);
}

// The manufacturers' Denavit-Hartenberg parameters, standard form: a, d, alpha.
struct DhRow {
  double a, d, alpha;
};

model::Pose FlangeByDh(const std::vector<DhRow>& rows, double base_height, const model::VecN& q) {
  model::Pose X;
  X.p = {0.0, 0.0, base_height};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double c = std::cos(q[static_cast<Eigen::Index>(i)]);
    const double s = std::sin(q[static_cast<Eigen::Index>(i)]);
    const double ca = std::cos(rows[i].alpha);
    const double sa = std::sin(rows[i].alpha);
    model::Pose step;
    step.R << c, -s * ca, s * sa, s, c * ca, -c * sa, 0, sa, ca;
    step.p = {rows[i].a * c, rows[i].a * s, rows[i].d};
    X = X * step;
  }
  return X;
}

TEST(RobotTest, Ur5eAndPuma560PosesMatchTheirParameters) {
  constexpr double kHalfPi = 1.5707963267948966;
  struct Case {
    const char* file;
    double base_height;
    std::vector<DhRow> rows;
  };
  const std::vector<Case> cases = {{"/ur5e.toml",
                                    0.0,
                                    {{0, 0.1625, kHalfPi},
                                     {-0.425, 0, 0},
                                     {-0.3922, 0, 0},
                                     {0, 0.1333, kHalfPi},
                                     {0, 0.0997, -kHalfPi},
                                     {0, 0.0996, 0}}},
                                   {"/puma560.toml",
                                    0.672,
                                    {{0, 0, kHalfPi},
                                     {0.4318, 0, 0},
                                     {0.0203, 0.15005, -kHalfPi},
                                     {0, 0.4318, kHalfPi},
                                     {0, 0, -kHalfPi},
                                     {0, 0.05625, 0}}}};
  for (const Case& c : cases) {
    const Robot robot = LoadRobot(test::RobotsFolder() + c.file);
    test::RandomStates random(71);
    double worst = 0.0;
    for (int k = 0; k < 500; ++k) {
      const model::VecN q = random.Position(robot.model);
      model::ArmPoses poses;
      model::ComputePoses(robot.model, q, poses);
      const model::Pose expected = FlangeByDh(c.rows, c.base_height, q);
      worst = std::max({worst, (poses.X_BE.p - expected.p).norm(), (poses.X_BE.R - expected.R).norm()});
    }
    std::cout << robot.name << ": worst difference " << worst << "\n";
    EXPECT_LT(worst, 1e-14);
  }
}

TEST(RobotTest, BareUrdfGetsDerivedLimitsAndItsOnlyLeafAsTip) {
  const Robot robot = LoadRobot((test::SourceRoot() / "tests/core/model/mixed_arm.urdf").string());
  EXPECT_EQ(robot.tip_link, "tool");
  EXPECT_EQ(robot.model.num_joints, 4);
  EXPECT_EQ(robot.model.joints[1].type, model::JointType::kPrismatic);
  EXPECT_GT(robot.model.joints[0].ddq_max, 0.0);
  EXPECT_GT(robot.model.joints[0].dddq_max, robot.model.joints[0].ddq_max);
  // Bracket and link 2 form one body: 2 + 0.7 kg.
  EXPECT_DOUBLE_EQ(robot.model.links[1].mass, 2.7);
}

// A valid two-joint arm; the tests break it.
std::string GoodUrdf() {
  return R"(<robot name="two">
  <link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="2" effort="10"/></joint>
  <link name="l1"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="b" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2" effort="10"/></joint>
  <link name="l2"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>)";
}

std::string Replace(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string ErrorOf(const std::string& urdf) {
  const test::TempFolder folder;
  const auto file = folder.path() / "arm.urdf";
  std::ofstream(file) << urdf;
  try {
    LoadRobot(file);
  } catch (const config::InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << "one line";
    EXPECT_THAT(what, HasSubstr("arm.urdf")) << "names the file";
    return what;
  }
  return "accepted";
}

TEST(RobotTest, AcceptsAGoodUrdf) { EXPECT_EQ(ErrorOf(GoodUrdf()), "accepted"); }

TEST(RobotTest, RefusesAUrdfItCannotDrive) {
  const std::string good = GoodUrdf();
  const std::string inertia2 =
      R"(<link name="l2"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>)";
  struct Case {
    std::string urdf;
    std::string words;
  };
  const std::vector<Case> cases = {
      {"", "not a usable URDF"},
      {"<robot name='x'>", "not a usable URDF"},
      {"no xml at all", "not a usable URDF"},
      {Replace(good, "type=\"revolute\"", "type=\"floating\""),
       "only revolute, continuous, prismatic and fixed"},
      {Replace(good, "type=\"revolute\"", "type=\"planar\""),
       "only revolute, continuous, prismatic and fixed"},
      {Replace(good, inertia2, "<link name=\"l2\"/>"), "without <inertial>"},
      {Replace(good, "<link name=\"base\"/>",
               "<link name=\"base\"><visual><geometry><cone/></geometry></visual></link>"),
       "cone"},  // urdfdom would ignore the shape
      {Replace(good, "mass value=\"1\"", "mass value=\"0\""), "the mass above 0"},
      {Replace(good, "ixx=\"0.01\"", "ixx=\"-0.01\""), "principal moments"},
      {Replace(good, "izz=\"0.01\"", "izz=\"0.03\""),
       "principal moments"},  // against the triangle inequality
      {Replace(good, "lower=\"-1\"", "lower=\"2\""), "lower limit"},
      {Replace(good, "velocity=\"2\"", "velocity=\"0\""), "must be above 0"},
      {Replace(good, "<limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"10\"/>", ""), "limits"},
      {Replace(good, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>"), "axis is zero"},
      {Replace(good, "</robot>",
               R"(<joint name="c" type="revolute"><parent link="l1"/><child link="l3"/><axis xyz="0 1 0"/>
               <limit lower="-1" upper="1" velocity="2" effort="10"/></joint><link name="l3"/></robot>)"),
       "links could be the end effector"},
      {Replace(good, "</robot>",
               R"(<joint name="c" type="fixed"><parent link="base"/><child link="l2"/></joint></robot>)"),
       "has two parent joints"},
      {Replace(good, "</robot>",
               R"(<joint name="c" type="fixed"><parent link="r1"/><child link="r2"/></joint><link name="r1"/>
               <joint name="d" type="fixed"><parent link="r2"/><child link="r1"/></joint><link name="r2"/></robot>)"),
       "is its own ancestor"},  // a ring beside the arm
      {Replace(good, "</robot>", "<link name=\"alone\"/></robot>"), "not a usable URDF"},  // two roots
      {Replace(good, "<limit lower", "<mimic joint=\"b\"/><limit lower"), "mimic"},
      {R"(<robot name="r"><link name="base"/></robot>)", "no moving joint"},
  };
  for (const Case& c : cases) {
    EXPECT_THAT(ErrorOf(c.urdf), HasSubstr(c.words));
  }
}

// urdfdom refuses this file and leaks the links of the ring.
TEST(RobotTest, RefusesARingOfLinksWithoutARoot) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler not_our_leak;
#endif
  EXPECT_THAT(ErrorOf(Replace(
                  GoodUrdf(), "</robot>",
                  R"(<joint name="c" type="fixed"><parent link="l2"/><child link="base"/></joint></robot>)")),
              HasSubstr("not a usable URDF"));
}

TEST(RobotTest, RefusesMoreJointsThanItHolds) {
  std::ostringstream urdf;
  urdf << "<robot name=\"long\"><link name=\"l0\"/>";
  for (int i = 1; i <= model::kMaxJoints + 1; ++i) {
    urdf << "<joint name=\"j" << i << "\" type=\"revolute\"><parent link=\"l" << i - 1
         << "\"/><child link=\"l" << i
         << "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"10\"/></joint>"
         << "<link name=\"l" << i
         << "\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\""
         << " ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
  }
  urdf << "</robot>";
  EXPECT_THAT(ErrorOf(urdf.str()), HasSubstr("more than 8 moving joints"));
}

TEST(RobotTest, ArmFileHasTheRotors) {
  const test::TempFolder folder;
  std::ofstream(folder.path() / "arm.urdf") << GoodUrdf();
  std::ofstream(folder.path() / "arm.toml") << "urdf = \"arm.urdf\"\nrotor_inertia = [0.25, 0.125]\n";
  const Robot robot = LoadRobot(folder.path() / "arm.toml");
  ASSERT_EQ(robot.model.num_joints, 2);
  EXPECT_EQ(robot.model.joints[0].rotor_inertia, 0.25);
  EXPECT_EQ(robot.model.joints[1].rotor_inertia, 0.125);
  EXPECT_EQ(LoadRobot(folder.path() / "arm.urdf").model.joints[0].rotor_inertia, 0.0);
}

TEST(RobotTest, ArmFileErrorsNameKeyAndLine) {
  const test::TempFolder folder;
  std::ofstream(folder.path() / "arm.urdf") << GoodUrdf();
  const auto error = [&](const std::string& toml) -> std::string {
    std::ofstream(folder.path() / "arm.toml") << toml;
    try {
      LoadRobot(folder.path() / "arm.toml");
    } catch (const config::InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_EQ(error("urdf = \"arm.urdf\"\n"), "accepted");
  EXPECT_THAT(error("base = \"base\"\n"), HasSubstr("urdf is missing"));
  EXPECT_THAT(error("urdf = \"none.urdf\"\n"), HasSubstr("no such file"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\nbase = \"x\"\n"), HasSubstr("base link \"x\""));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\ntip = \"x\"\n"), HasSubstr("no end effector"));
  // The arm's links form a ring; another link is the root.
  std::ofstream(folder.path() / "ring.urdf") << Replace(
      GoodUrdf(), "</robot>",
      R"(<joint name="c" type="fixed"><parent link="l2"/><child link="base"/></joint><link name="world"/></robot>)");
  EXPECT_THAT(error("urdf = \"ring.urdf\"\nbase = \"base\"\ntip = \"l2\"\n"),
              HasSubstr("a loop is not a serial arm"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\nbase = \"l2\"\ntip = \"l1\"\n"),
              HasSubstr("does not descend from"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\njerk_max = [1.0]\n"), HasSubstr("jerk_max has 1 entries"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\nready = [0.0, 5.0]\n"), HasSubstr("outside the joint's range"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\nrotor_inertia = [0.1]\n"),
              HasSubstr("rotor_inertia has 1 entries"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\nrotor_inertia = [0.1, -0.1]\n"), HasSubstr("rotor_inertia"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\nreday = [0.0, 0.0]\n"), HasSubstr("did you mean ready?"));
  EXPECT_THAT(error("urdf = \"arm.urdf\"\njerk_max = [1.0, -2.0]\n"), HasSubstr("arm.toml:2"));
}

}  // namespace
}  // namespace fovea::robots
