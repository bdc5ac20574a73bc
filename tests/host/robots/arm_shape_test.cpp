// SPDX-License-Identifier: Apache-2.0
// Capsules from a robot's description: they enclose their bodies, and the pairs are those that can touch.
#include "firmware/host/robots/arm_shape.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <utility>

#include "firmware/core/model/rotation.hpp"
#include "firmware/core/model/segments.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::robots {
namespace {

using model::Capsule;
using model::Vec3;

double Outside(const Capsule& capsule, const Vec3& p) {
  return model::NearestOfSegments(p, p, capsule.p_LA, capsule.p_LB).distance - capsule.radius;
}

model::Pose SomePose() { return {model::RotationOf(Vec3(0.4, -1.1, 0.7)), Vec3(0.1, -0.2, 0.3)}; }

TEST(ArmShapeTest, CylinderCapsuleEnclosesTheRims) {
  const model::Pose X = SomePose();
  const Capsule capsule = CapsuleOfCylinder(X, 0.3, 0.05);
  for (const double angle : {0.0, 1.0, 2.5, 4.0}) {
    for (const double z : {-0.15, 0.0, 0.15}) {
      const Vec3 rim(0.05 * std::cos(angle), 0.05 * std::sin(angle), z);
      EXPECT_NEAR(Outside(capsule, X * rim), 0.0, 1e-12);
    }
  }
}

TEST(ArmShapeTest, BoxCapsuleEnclosesTheCorners) {
  const model::Pose X = SomePose();
  const Capsule capsule = CapsuleOfBox(X, Vec3(0.1, 0.4, 0.06));
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    EXPECT_NEAR(Outside(capsule, X * Vec3(0.5 * sign.cwiseProduct(Vec3(0.1, 0.4, 0.06)))), 0.0, 1e-12);
  }
}

TEST(ArmShapeTest, OneCapsuleEnclosesAllPartsOfALink) {
  test::RandomStates random(3);
  const auto somewhere = [&random] {
    return Vec3(random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2));
  };
  for (int k = 0; k < 100; ++k) {
    std::vector<Capsule> parts(3);
    for (Capsule& part : parts) {
      part = {somewhere(), somewhere(), random.Uniform(0.01, 0.1)};
    }
    const Capsule held = Hold(parts);
    for (const Capsule& part : parts) {
      for (int i = 0; i < 100; ++i) {
        const Vec3 on_axis = part.p_LA + random.Uniform(0.0, 1.0) * (part.p_LB - part.p_LA);
        EXPECT_LT(Outside(held, on_axis + part.radius * somewhere().normalized()), 1e-12);
      }
    }
    const Capsule alone = Hold({parts[0]});
    EXPECT_EQ(alone.radius, parts[0].radius);
    EXPECT_EQ(alone.p_LA, parts[0].p_LA);
  }
}

using BodyPair = std::pair<int, int>;

std::vector<BodyPair> PairsOf(const model::ArmShape& shape) {
  std::vector<BodyPair> pairs;
  for (std::size_t k = 0; k < static_cast<std::size_t>(shape.num_pairs); ++k) {
    pairs.emplace_back(shape.pairs[k].near, shape.pairs[k].far);
  }
  return pairs;
}

model::ArmShape Shipped(const std::string& name) {
  return LoadRobot(test::RobotsFolder() + "/" + name + ".toml").model.shape;
}

TEST(ArmShapeTest, ForearmAndHandOfThePandaCanTouchBaseAndUpperArm) {
  const model::ArmShape panda = Shipped("panda");
  EXPECT_EQ(panda.bodies[0].radius, 0.08);
  EXPECT_EQ(panda.bodies[7].radius, 0.046);
  EXPECT_THAT(PairsOf(panda),
              testing::IsSupersetOf<BodyPair>({{0, 5}, {0, 6}, {0, 7}, {1, 5}, {1, 6}, {1, 7}, {2, 7}}));
  EXPECT_THAT(PairsOf(panda), testing::Not(testing::Contains(BodyPair(3, 7)))) << "never closer than 11 cm";
}

TEST(ArmShapeTest, LinksBuiltCloseTogetherAreNoPair) {
  EXPECT_THAT(PairsOf(Shipped("puma560")), testing::Not(testing::Contains(BodyPair(3, 6))));
  EXPECT_THAT(PairsOf(Shipped("ur5e")), testing::Contains(BodyPair(2, 6)));
  EXPECT_THAT(PairsOf(Shipped("slider")), testing::IsEmpty());
}

// The shipped Panda, with `replacement` in place of every collision element.
class EditedPanda {
 public:
  explicit EditedPanda(const std::string& replacement) {
    std::ifstream in(test::RobotsFolder() + "/panda.urdf");
    std::ofstream out(file());
    for (std::string line; std::getline(in, line);) {
      out << (line.find("<collision>") == std::string::npos ? line : replacement) << '\n';
    }
  }
  [[nodiscard]] std::string file() const { return folder_.path() / "arm.urdf"; }

 private:
  test::TempFolder folder_;
};

TEST(ArmShapeTest, MeshOnlyLinkGetsACapsuleFromJointToJoint) {
  const EditedPanda edited("<collision><geometry><mesh filename=\"link.stl\"/></geometry></collision>");
  const model::ArmModel arm = LoadRobot(edited.file()).model;
  EXPECT_EQ(arm.shape.bodies[0].p_LB, arm.joints[0].X_PJ.p);
  EXPECT_EQ(arm.shape.bodies[7].p_LB, arm.X_LnE.p);
  EXPECT_EQ(arm.shape.bodies[7].radius, 0.055);
  EXPECT_THAT(PairsOf(arm.shape), testing::IsSupersetOf<BodyPair>({{0, 7}, {1, 7}, {2, 7}}));
}

TEST(ArmShapeTest, RefusesACollisionBodyWithoutASize) {
  const EditedPanda edited(
      "<collision><geometry><cylinder radius=\"0\" length=\"0.1\"/></geometry></collision>");
  try {
    LoadRobot(edited.file());
    FAIL() << "accepted";
  } catch (const config::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("<collision>: sizes must be finite and above 0"));
  }
}

}  // namespace
}  // namespace fovea::robots
