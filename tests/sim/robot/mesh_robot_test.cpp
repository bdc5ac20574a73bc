// SPDX-License-Identifier: Apache-2.0
// A robot with mesh links: drawn like the same solids as URDF shapes, and touching the table like them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "sim/physics/bullet_arm.hpp"
#include "sim/render/mesh.hpp"
#include "sim/render/outline_smoother.hpp"
#include "sim/render/scene_renderer.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

using Eigen::Vector3f;
using testing::AllOf;
using testing::HasSubstr;

const Vector3f kSize(0.16F, 0.10F, 0.30F);  // of the link
constexpr const char* kBox = "<box size=\"0.16 0.10 0.30\"/>";
constexpr const char* kMaterial = "<material name=\"m\"><color rgba=\"0.2 0.5 0.7 1\"/></material>";

class MeshRobotTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.path() / name; }

  // A vertical slider whose link has `visual` and `collision` geometry and is 0.3 m high.
  SimRobot Slider(const std::string& visual, const std::string& collision,
                  const std::string& material = kMaterial) {
    std::ofstream(Path("arm.urdf")) << R"(<robot name="slider"><link name="base"/>
      <joint name="j" type="prismatic"><parent link="base"/><child link="l1"/><origin xyz="0.4 0 0"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="2" effort="100"/></joint>
      <link name="l1"><inertial><mass value="1"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry>)"
                                    << visual << "</geometry>" << material << "</visual><collision><geometry>"
                                    << collision << "</geometry></collision></link></robot>";
    return LoadSimRobot(Path("arm.urdf"), "base", "l1");
  }

  static std::string MeshTag(const std::string& file, const std::string& more = "") {
    return "<mesh filename=\"" + file + "\" " + more + "/>";
  }

  cv::Mat Draw(const SimRobot& robot, double* frame_ms = nullptr) const {
    RenderScene scene;
    scene.bench = ShareBench(/*clutter=*/false, {});
    scene.robot = robot;
    scene.X_EC.translation() = Eigen::Vector3d(0.0, 0.0, -0.5);  // the camera's housing is out of sight
    Exposure exposure;
    exposure.p_BO = {0.3, -0.25, 0.04};
    exposure.X_BL = {Eigen::Isometry3d::Identity(),
                     Eigen::Isometry3d(Eigen::Translation3d(0.4, 0.0, 0.2) *
                                       Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()))};
    Eigen::Isometry3d X_BV = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d eye(0.9, -0.6, 0.6);
    const Eigen::Vector3d z = (Eigen::Vector3d(0.4, 0.0, 0.15) - eye).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    X_BV.linear() << x, z.cross(x), z;
    X_BV.translation() = eye;
    const Pinhole pinhole = MakePinhole(640, 480, 0.9);
    SceneRenderer renderer(scene, pinhole, {});
    cv::Mat rgba(pinhole.height_px, pinhole.width_px, CV_8UC4);
    renderer.Draw(exposure, X_BV, {rgba.data, rgba.total() * 4});
    if (frame_ms != nullptr) {
      const auto begin = std::chrono::steady_clock::now();
      for (int i = 0; i < 5; ++i) {
        renderer.Draw(exposure, X_BV, {rgba.data, rgba.total() * 4});
      }
      *frame_ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count() / 5;
    }
    return rgba;
  }

  // The slider height at which the link touches the table from above [m].
  static double TouchHeight(const SimRobot& robot) {
    BulletArm arm(robot, {.integrator = Integrator::kSemiImplicitEuler, .table = true, .gravity = false});
    Eigen::VectorXd q(1);
    for (q[0] = 0.25; q[0] > 0.0; q[0] -= 1e-4) {
      arm.SetState(q, Eigen::VectorXd::Zero(1));
      arm.Step(Eigen::VectorXd::Zero(1), 1e-6);
      if (arm.Contacts() > 0) {
        return q[0];
      }
    }
    return -1.0;
  }

  const test::TempFolder folder_;
};

struct Residual {
  double mean = 0.0;   // gray levels
  double share = 0.0;  // of pixels that differ by more than 8
};

Residual Compare(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  cv::cvtColor(difference, difference, cv::COLOR_RGBA2GRAY);
  return {cv::mean(difference)[0],
          static_cast<double>(cv::countNonZero(difference > 8)) / static_cast<double>(difference.total())};
}

TEST_F(MeshRobotTest, BoxMeshIsRenderedLikeABox) {
  const cv::Mat box = Draw(Slider(kBox, kBox));
  const Residual nothing = Compare(box, Draw(Slider("<sphere radius=\"0.001\"/>", kBox)));
  // The renderer's own triangles with rounded edges; as a box their shadow would have sharp corners.
  test::WriteObj(Path("round.obj"), MakeBox(kSize, 0.008F, Vector3f::Ones()), /*normals=*/true);
  const Residual same = Compare(box, Draw(Slider(MeshTag("round.obj"), kBox)));
  // In millimetres, with sharp edges.
  test::WriteStlBinary(Path("sharp.stl"), MakeBox(1000.0F * kSize, 0.0F, Vector3f::Ones()));
  const Residual sharp =
      Compare(box, Draw(Slider(MeshTag("sharp.stl", "scale=\"0.001 0.001 0.001\""), kBox)));
  for (const auto& [what, residual] :
       {std::pair{"no link", nothing}, {"the same triangles", same}, {"sharp edges", sharp}}) {
    std::cout << what << ": differs by " << residual.mean << " gray levels on average, by more than 8 in "
              << 100.0 * residual.share << " % of the pixels\n";
  }
  EXPECT_GT(nothing.share, 0.1) << "the link is not in the picture";
  EXPECT_LT(same.mean, 0.1);
  EXPECT_LT(same.share, 0.005);
  EXPECT_LT(sharp.mean, 0.5);
  EXPECT_LT(sharp.share, 0.02);
}

TEST_F(MeshRobotTest, UrdfColourOverridesTheColourOfTheFile) {
  test::WriteDae(Path("box.dae"), MakeBox(kSize, 0.0F, Vector3f::Ones()), "<up_axis>Z_UP</up_axis>");
  const SimRobot own = Slider(MeshTag("box.dae"), kBox, "");
  EXPECT_TRUE(own.links[1].visuals[0].mesh->vertices[0].colour.isApprox(Vector3f(0.8F, 0.1F, 0.2F), 1e-5F));
  const SimRobot given = Slider(MeshTag("box.dae"), kBox);
  EXPECT_TRUE(given.links[1].visuals[0].mesh->vertices[0].colour.isApprox(Vector3f(0.2F, 0.5F, 0.7F), 1e-5F));
  // Drawing is repeatable: the same link gives the same picture.
  const double worst = cv::norm(Draw(given), Draw(Slider(MeshTag("box.dae"), kBox, kMaterial)), cv::NORM_INF);
  EXPECT_EQ(worst, 0.0);
  EXPECT_GT(cv::norm(Draw(given), Draw(own), cv::NORM_INF), 50.0);
}

TEST_F(MeshRobotTest, MeshTouchesTheTableWhereItsHullDoes) {
  test::WriteStlText(Path("box.stl"), MakeBox(kSize, 0.0F, Vector3f::Ones()));
  const double box = TouchHeight(Slider(kBox, kBox));
  const double mesh = TouchHeight(Slider(kBox, MeshTag("box.stl")));
  std::cout << "touches at " << box << " m as a box, at " << mesh << " m as a mesh\n";
  EXPECT_NEAR(box, 0.15, 2e-4);
  EXPECT_NEAR(mesh, box, 2e-4);
  EXPECT_NEAR(TouchHeight(Slider(kBox, MeshTag("box.stl", "scale=\"1 1 0.5\""))), 0.075, 2e-4);
}

// A link dropped onto the table comes to rest on it.
TEST_F(MeshRobotTest, DroppedMeshComesToRestOnTheTable) {
  test::WriteStlText(Path("box.stl"), MakeBox(kSize, 0.0F, Vector3f::Ones()));
  BulletArm arm(Slider(kBox, MeshTag("box.stl")), {});
  arm.SetState(Eigen::VectorXd::Constant(1, 0.17), Eigen::VectorXd::Zero(1));
  for (int i = 0; i < 1000; ++i) {
    arm.Step(Eigen::VectorXd::Zero(1), 1e-3);
  }
  std::cout << "rests " << 1e3 * (arm.q()[0] - 0.15) << " mm over the table\n";
  EXPECT_NEAR(arm.q()[0], 0.15, 1e-3);
  EXPECT_LT(std::fabs(arm.dq()[0]), 1e-3);
}

// The cost per frame stays small: no edges are smoothed, and few triangles cast the shadow.
TEST_F(MeshRobotTest, DenseMeshIsDrawnWithoutEdgesAndWithASimpleShadow) {
  const Mesh dense = MakeSphere(0.14F, 450, Vector3f::Ones());
  test::WriteStlBinary(Path("dense.stl"), dense);
  const SimRobot robot = Slider(MeshTag("dense.stl"), MeshTag("dense.stl"));
  const Shape& visual = robot.links[1].visuals[0];
  const std::size_t shadow = MakeShape(visual, Detail::kShadow).num_triangles();
  double frame_ms = 0.0;
  Draw(robot, &frame_ms);
  std::cout << dense.num_triangles() << " triangles, " << shadow << " for the shadow: drawn in " << frame_ms
            << " ms\n";
  EXPECT_TRUE(FindEdges(*visual.mesh).empty());
  EXPECT_GT(shadow, 500U);
  EXPECT_LT(shadow, dense.num_triangles() / 4);
}

TEST_F(MeshRobotTest, ErrorNamesUrdfLinkAndMesh) {
  const auto refusal = [&](const std::string& visual, const std::string& collision) -> std::string {
    try {
      Slider(visual, collision);
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
      return error.what();
    }
    return "accepted";
  };
  const std::string gone = refusal(MeshTag("package://nobody/gone.stl"), kBox);
  EXPECT_THAT(gone, AllOf(HasSubstr("arm.urdf: link \"l1\": mesh \"package://nobody/gone.stl\": "),
                          HasSubstr("no folder of package \"nobody\"")));
  EXPECT_THAT(refusal(kBox, MeshTag("gone.stl")),
              AllOf(HasSubstr("mesh \"gone.stl\""), HasSubstr("no such file")));
  test::WriteStlBinary(Path("a.stl"), MakeBox(kSize, 0.0F, Vector3f::Ones()));
  EXPECT_THAT(refusal(MeshTag("a.stl", "scale=\"0 1 1\""), kBox),
              AllOf(HasSubstr("link \"l1\": mesh \"a.stl\""), HasSubstr("scale = 0 1 1 is not allowed")));
  std::ofstream(Path("a.step")) << "x";
  EXPECT_THAT(refusal(MeshTag("a.step"), kBox), HasSubstr(".stl, .dae and .obj"));
  EXPECT_EQ(refusal(MeshTag("a.stl"), MeshTag("a.stl")), "accepted");
}

}  // namespace
}  // namespace fovea::sim
