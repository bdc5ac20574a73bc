// SPDX-License-Identifier: Apache-2.0
// A red target half in sun and half in shade is found by its colour, with the right position.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "firmware/vision/pose/flat_corners.hpp"
#include "tools/bench/vision/picture.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::vision {
namespace {

using model::Vec3;

class ShadedTargetTest : public testing::TestWithParam<hal::FeatureKind> {
 protected:
  static DetectorConfig Config() {
    const bench::PictureCamera camera;
    DetectorConfig config;
    config.LookFor(bench::TargetOf(GetParam()));
    config.by = FindBy::kColour;
    config.intrinsics = {camera.width_px, camera.height_px, camera.f_px,
                         camera.f_px,     camera.c_u_px,    camera.c_v_px};
    return config;
  }

  // The target is tilted by `tilt` against the line of sight [rad].
  static bench::PictureScene Scene(const DetectorConfig& config, double tilt, std::mt19937& engine) {
    const auto uniform = [&](double a, double b) {
      return std::uniform_real_distribution<double>(a, b)(engine);
    };
    bench::PictureScene scene;
    scene.gray = false;
    scene.noise = 2.0;
    scene.seed = static_cast<unsigned>(engine());
    scene.ground_bgr = {90.0, 100.0, 105.0};
    bench::Body body;
    body.shape = bench::Shape::kPolygon;
    body.bgr = {25.0, 25.0, 200.0};
    body.corners = FlatCorners(config.corners);
    body.p.z() = uniform(0.3, 0.45);
    body.p.x() = body.p.z() * uniform(-0.2, 0.2);
    body.p.y() = body.p.z() * uniform(-0.12, 0.12);
    const Vec3 ray = body.p.normalized();
    const Vec3 about = ray.cross(Vec3(uniform(-1.0, 1.0), uniform(-1.0, 1.0), 0.0)).normalized();
    body.R = model::RotationOf(tilt * about) *
             model::RotationOf(std::acos(ray.z()) * Vec3::UnitZ().cross(ray).normalized()) *
             model::RotationOf({0.0, 0.0, uniform(-3.0, 3.0)});
    scene.bodies.push_back(body);
    return scene;
  }

  // Reduces the light to 0.3 on one side of a line near the target's centre, with a soft edge.
  static void Shade(const bench::PictureScene& scene, std::mt19937& engine, cv::Mat& image) {
    constexpr double kDark = 0.3;
    constexpr double kSoftPx = 2.0;
    const Vec3& p = scene.bodies.front().p;
    const double angle = std::uniform_real_distribution<double>(0.0, 2.0 * std::numbers::pi)(engine);
    const double off = std::uniform_real_distribution<double>(-10.0, 10.0)(engine);
    const double u0 = scene.camera.c_u_px + scene.camera.f_px * p.x() / p.z();
    const double v0 = scene.camera.c_v_px + scene.camera.f_px * p.y() / p.z();
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const double side = (u - u0) * std::cos(angle) + (v - v0) * std::sin(angle) - off;
        const double light = kDark + (1.0 - kDark) / (1.0 + std::exp(-side / kSoftPx));
        image.at<cv::Vec3b>(v, u) *= light;
      }
    }
  }

  struct Found {
    int count = 0;
    double worst_px = 0.0;
  };

  static Found Look(double tilt, bool shaded, int pictures) {
    const DetectorConfig config = Config();
    std::mt19937 engine(11);
    Found found;
    for (int i = 0; i < pictures; ++i) {
      const bench::PictureScene scene = Scene(config, tilt, engine);
      cv::Mat image = bench::Draw(scene);
      if (shaded) {
        Shade(scene, engine, image);
      }
      TargetDetector detector(config);
      const Detection d = detector.Detect(image);
      if (!d.found) {
        continue;
      }
      ++found.count;
      const bench::TrueOutline truth = bench::OutlineOf(scene.camera, scene.bodies.front());
      double u = 0.0;
      double v = 0.0;
      for (const Eigen::Vector2d& corner : scene.bodies.front().corners) {
        const Vec3 p = scene.bodies.front().p + scene.bodies.front().R * Vec3(corner.x(), corner.y(), 0.0);
        u += config.intrinsics.U(p) / static_cast<double>(scene.bodies.front().corners.size());
        v += config.intrinsics.V(p) / static_cast<double>(scene.bodies.front().corners.size());
      }
      found.worst_px = std::max(found.worst_px, std::hypot(d.u_px - u, d.v_px - v));
      found.worst_px = std::max(found.worst_px, std::fabs(d.radius_px - truth.radius_px));
    }
    std::cout << "found " << found.count << " of " << pictures << ", centre and radius off by at most "
              << found.worst_px << " px\n";
    return found;
  }
};

TEST_P(ShadedTargetTest, IsFoundUnderAShadowEdge) {
  const Found found = Look(0.4, true, 40);
  EXPECT_GE(found.count, 36);
  EXPECT_LT(found.worst_px, 0.3);
}

TEST_P(ShadedTargetTest, IsFoundAt66DegreesToTheLineOfSight) {
  const Found found = Look(1.15, false, 20);  // 66 degrees against the line of sight
  EXPECT_GE(found.count, 18);
  EXPECT_LT(found.worst_px, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ShadedTargetTest,
                         testing::Values(hal::FeatureKind::kSquare, hal::FeatureKind::kTriangle));

}  // namespace
}  // namespace fovea::vision
