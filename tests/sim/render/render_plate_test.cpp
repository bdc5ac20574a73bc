// SPDX-License-Identifier: Apache-2.0
// Rendered flat targets compared with their projection. Two pictures in two colours give each pixel's
// coverage, and from it the target's area and centre.
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <opencv2/core.hpp>

#include "sim/physics/bullet_arm.hpp"
#include "sim/render/scene_renderer.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

struct Blob {
  double area_px = 0.0;
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
};

class RenderPlateTest : public ::testing::Test {
 protected:
  RenderPlateTest() {
    scene_.bench = ShareBench(/*clutter=*/false, {});
    scene_.robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
    BulletArm arm(scene_.robot, {});
    Eigen::VectorXd q(7);
    q << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
    arm.SetState(q, Eigen::VectorXd::Zero(7));
    for (int i = 0; i < static_cast<int>(scene_.robot.links.size()); ++i) {
      exposure_.X_BL.push_back(arm.LinkPose(i));
    }
    scene_.X_EC.translation() = Eigen::Vector3d(0.05, 0.0, 0.04);  // where the hand does not occlude the view
    exposure_.X_BC = arm.LinkPose(scene_.robot.tip) * scene_.X_EC;
  }

  std::unique_ptr<SceneRenderer> MakeRenderer(float brightness, int index) {
    scene_.target_colour.setConstant(brightness);
    auto renderer = std::make_unique<SceneRenderer>(scene_, pinhole_, RenderQuality{}, index);
    renderer->Release();
    return renderer;
  }

  // Draws the target at `X_CO`.
  cv::Mat Draw(SceneRenderer& renderer, const Eigen::Isometry3d& X_CO) {
    const Eigen::Isometry3d X_BO = exposure_.X_BC * X_CO;
    exposure_.p_BO = X_BO.translation();
    exposure_.R_BO = X_BO.linear();
    cv::Mat rgba(pinhole_.height_px, pinhole_.width_px, CV_8UC4);
    renderer.Draw(exposure_, exposure_.X_BC, {rgba.data, rgba.total() * 4});
    renderer.Release();
    return rgba;
  }

  // Covered area and centre, from the difference of a dark and a bright plate.
  Blob Covered(const Eigen::Isometry3d& X_CO) {
    const cv::Mat dark = Draw(*dark_, X_CO);
    const cv::Mat bright = Draw(*bright_, X_CO);
    const auto middle_u = static_cast<int>(pinhole_.U(X_CO.translation()));
    const auto middle_v = static_cast<int>(pinhole_.V(X_CO.translation()));
    const auto difference = [&](int v, int u) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) {
        sum += bright.at<cv::Vec4b>(v, u)[k] - dark.at<cv::Vec4b>(v, u)[k];
      }
      return sum;
    };
    const double full = difference(middle_v, middle_u);
    EXPECT_GT(full, 100.0) << "the plate is lit and not occluded";
    Blob blob;
    for (int v = 0; v < pinhole_.height_px; ++v) {
      for (int u = 0; u < pinhole_.width_px; ++u) {
        const double cover = difference(v, u) / full;
        blob.area_px += cover;
        blob.middle_px += cover * Eigen::Vector2d(u, v);
      }
    }
    blob.middle_px /= blob.area_px;
    return blob;
  }

  // Area and centre of the projected outline, by the shoelace formula.
  Blob Expected(const Eigen::Isometry3d& X_CO) const {
    std::vector<Eigen::Vector2d> outline;
    const auto add = [&](const Eigen::Vector2d& xy) {
      const Eigen::Vector3d p = X_CO * Eigen::Vector3d(xy.x(), xy.y(), 0.0);
      outline.emplace_back(pinhole_.U(p), pinhole_.V(p));
    };
    if (scene_.target.kind == TargetShape::Kind::kDisc) {
      for (int i = 0; i < 2000; ++i) {
        const double a = 2.0 * M_PI * i / 2000;
        add(scene_.target.radius * Eigen::Vector2d(std::cos(a), std::sin(a)));
      }
    }
    for (const Eigen::Vector2d& corner : scene_.target.corners) {
      add(corner);
    }
    Blob blob;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d& a = outline[i];
      const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
      const double cross = a.x() * b.y() - a.y() * b.x();
      blob.area_px += 0.5 * cross;
      blob.middle_px += cross / 6.0 * (a + b);
    }
    blob.middle_px /= blob.area_px;
    blob.area_px = std::fabs(blob.area_px);
    return blob;
  }

  void Compare(const char* name) {
    dark_ = MakeRenderer(0.0F, 0);
    bright_ = MakeRenderer(0.7F, 1);
    for (const Eigen::Vector3d& tilt : {Eigen::Vector3d(0.0, 0.0, 0.3), Eigen::Vector3d(0.5, -0.3, 1.1)}) {
      Eigen::Isometry3d X_CO = Eigen::Isometry3d::Identity();
      X_CO.linear() = Eigen::AngleAxisd(tilt.norm(), tilt.normalized()).toRotationMatrix();
      X_CO.translation() = Eigen::Vector3d(0.03, -0.02, 0.25);
      const Blob seen = Covered(X_CO);
      const Blob expected = Expected(X_CO);
      const double off_px = (seen.middle_px - expected.middle_px).norm();
      const double area = seen.area_px / expected.area_px - 1.0;
      std::cout << name << ": centre off by " << off_px << " px, area by " << 100.0 * area << " %\n";
      EXPECT_LT(off_px, 0.005);
      EXPECT_LT(std::fabs(area), 1e-4);
    }
  }

  const Pinhole pinhole_ = MakePinhole(640, 480, 1.0471975511965976);
  RenderScene scene_;
  Exposure exposure_;
  std::unique_ptr<SceneRenderer> dark_;
  std::unique_ptr<SceneRenderer> bright_;
};

TEST_F(RenderPlateTest, SquareCoversItsProjectedPixels) {
  scene_.target.kind = TargetShape::Kind::kPolygon;
  scene_.target.corners = {{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  Compare("square");
}

TEST_F(RenderPlateTest, TriangleCoversItsProjectedPixels) {
  scene_.target.kind = TargetShape::Kind::kPolygon;
  scene_.target.corners = {{-0.06, 0.022}, {0.06, 0.022}, {-0.015, -0.044}};
  Compare("triangle");
}

TEST_F(RenderPlateTest, DiscCoversItsProjectedPixels) {
  scene_.target.kind = TargetShape::Kind::kDisc;
  scene_.target.radius = 0.04;
  Compare("disc");
}

// The back of a plate is not painted.
TEST_F(RenderPlateTest, PlateTurnedAwayIsInvisible) {
  scene_.target.kind = TargetShape::Kind::kDisc;
  Eigen::Isometry3d X_CO = Eigen::Isometry3d::Identity();
  X_CO.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  X_CO.translation() = Eigen::Vector3d(0.0, 0.0, 0.25);
  dark_ = MakeRenderer(0.0F, 0);
  bright_ = MakeRenderer(0.7F, 1);
  EXPECT_EQ(cv::norm(Draw(*dark_, X_CO), Draw(*bright_, X_CO), cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace fovea::sim
