// SPDX-License-Identifier: Apache-2.0
// Lens and sensor: the formula against OpenCV's, the resampled picture against the
// ideal projection, and the detector with the same lens.
#include "sim/camera/lens.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <tuple>

#include "firmware/vision/detect/target_detector.hpp"
#include "sim/camera/optics.hpp"

namespace fovea::sim {
namespace {

const Lens kLens{-0.20, 0.06, 0.0015, -0.001, 0.01};

TEST(LensTest, MatchesOpenCvAndRoundTrips) {
  const Pinhole pinhole = MakePinhole(640, 480, 1.047);
  const cv::Matx33d K(pinhole.f_px, 0.0, pinhole.c_u_px, 0.0, pinhole.f_px, pinhole.c_v_px, 0.0, 0.0, 1.0);
  std::vector<cv::Point3d> points;
  for (int column = -6; column <= 6; ++column) {
    for (int row = -4; row <= 4; ++row) {
      points.emplace_back(0.1 * column, 0.11 * row, 1.0);
    }
  }
  std::vector<cv::Point2d> truth;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K,
                    std::vector<double>{kLens.k1, kLens.k2, kLens.p1, kLens.p2, kLens.k3}, truth);
  double off_px = 0.0;
  double back = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d xy(points[i].x, points[i].y);
    const Eigen::Vector2d seen = Distort(kLens, xy);
    off_px = std::max(off_px, std::hypot(pinhole.f_px * seen.x() + pinhole.c_u_px - truth[i].x,
                                         pinhole.f_px * seen.y() + pinhole.c_v_px - truth[i].y));
    Eigen::Vector2d again;
    ASSERT_TRUE(Undistort(kLens, seen, again));
    back = std::max(back, (again - xy).norm());
  }
  std::cout << "off OpenCV's by " << off_px << " px, back within " << back << "\n";
  EXPECT_LT(off_px, 1e-9);
  EXPECT_LT(back, 1e-9);
}

// A lens that folds the picture maps two points onto one.
TEST(LensTest, LensThatFoldsThePictureIsRefused) {
  const Pinhole wide = MakePinhole(640, 480, 1.9);
  EXPECT_THROW(LensMap({-0.9, 0.0, 0.0, 0.0, 0.0}, wide), std::invalid_argument);
  EXPECT_THROW(LensMap({-0.5, 0.0, 0.0, 0.0, 0.0}, MakePinhole(64, 48, 2.6)), std::invalid_argument);
}

// The map goes along rows. It refuses the same lenses as the search from the centre for each of its points.
TEST(LensTest, MapRefusesWhatTheSearchFromTheCentreRefuses) {
  std::mt19937 engine(5);
  const auto uniform = [&](double size) {
    return std::uniform_real_distribution<double>(-size, size)(engine);
  };
  int refused = 0;
  constexpr int kLenses = 300;
  for (int k = 0; k < kLenses; ++k) {
    const Lens lens{uniform(0.8), uniform(0.6), uniform(0.05), uniform(0.05), uniform(0.4)};
    const Pinhole pinhole = MakePinhole(32, 24, 1.4);
    bool all = true;
    for (int i = 0; i < 4 * 32 * 24; ++i) {
      const double u = i / 4 % 32 + (i % 2 == 0 ? -0.25 : 0.25);
      const double v = i / 4 / 32 + (i % 4 < 2 ? -0.25 : 0.25);
      Eigen::Vector2d ideal;
      all = all &&
            Undistort(lens, {(u - pinhole.c_u_px) / pinhole.f_px, (v - pinhole.c_v_px) / pinhole.FocalV()},
                      ideal);
    }
    bool accepted = true;
    try {
      const LensMap map(lens, pinhole);
    } catch (const std::invalid_argument&) {
      accepted = false;
    }
    EXPECT_EQ(accepted, all) << lens.k1 << ' ' << lens.k2 << ' ' << lens.p1 << ' ' << lens.p2 << ' '
                             << lens.k3;
    refused += all ? 0 : 1;
  }
  std::cout << refused << " of " << kLenses << " refused\n";
  EXPECT_GT(refused, 30);
  EXPECT_LT(refused, 270);
}

// In a picture of brightness a + b u + c v each resampled pixel shows its ideal position.
class SensorTest : public testing::TestWithParam<std::tuple<Lens, Pinhole>> {};

TEST_P(SensorTest, ResamplesByTheCamerasFormula) {
  const auto& [lens, pinhole] = GetParam();
  ASSERT_TRUE(NeedsLensMap(lens, pinhole));
  const LensMap map(lens, pinhole);
  EXPECT_TRUE(map.wide().IsPlain());
  const Pinhole& wide = map.wide();
  const auto pixels = static_cast<std::size_t>(wide.width_px) * static_cast<std::size_t>(wide.height_px);
  std::vector<std::uint8_t> from(4 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto width = static_cast<std::size_t>(wide.width_px);
    from[4 * i] = static_cast<std::uint8_t>(255 * (i % width) / width);
    from[4 * i + 1] = static_cast<std::uint8_t>(255 * (i / width) / static_cast<std::size_t>(wide.height_px));
  }
  std::vector<std::uint8_t> to(std::size_t{4} * 160 * 120);
  map.Apply(from, to);
  double worst = 0.0;
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      Eigen::Vector2d ideal;
      ASSERT_TRUE(Undistort(
          lens, {(u - pinhole.c_u_px) / pinhole.f_px, (v - pinhole.c_v_px) / pinhole.FocalV()}, ideal));
      const auto at = 4 * static_cast<std::size_t>(160 * v + u);
      worst =
          std::max({worst, std::fabs(to[at] - 255.0 * (wide.f_px * ideal.x() + wide.c_u_px) / wide.width_px),
                    std::fabs(to[at + 1] - 255.0 * (wide.f_px * ideal.y() + wide.c_v_px) / wide.height_px)});
    }
  }
  std::cout << "off by " << worst << " of 255 gray levels, in a picture of whole gray levels\n";
  EXPECT_LT(worst, 1.6);
}

// A sensor with pixels that are not square and a principal point off the centre.
Pinhole OwnSensor() { return {160, 120, 146.0, 71.2, 66.1, 1.03}; }

INSTANTIATE_TEST_SUITE_P(Cameras, SensorTest,
                         testing::Values(std::tuple(kLens, MakePinhole(160, 120, 1.0)),
                                         std::tuple(Lens{}, OwnSensor()), std::tuple(kLens, OwnSensor())));

TEST(LensTest, PlainCameraNeedsNoResampling) {
  EXPECT_FALSE(NeedsLensMap({}, MakePinhole(160, 120, 1.0)));
  Pinhole beside = MakePinhole(160, 120, 1.0);
  beside.c_v_px += 0.5;
  EXPECT_TRUE(NeedsLensMap({}, beside));
}

// Balls near the corners, through the lens: the detector's position against the true one.
TEST(LensTest, DetectorUndoesTheLens) {
  RenderScene scene;
  scene.bench = ShareBench(/*clutter=*/false, {});
  const Pinhole pinhole = MakePinhole(640, 480, 1.047);
  Optics optics(scene, pinhole, kLens, Sampling::kPlain);
  vision::DetectorConfig config;
  config.intrinsics = {640,
                       480,
                       pinhole.f_px,
                       pinhole.f_px,
                       pinhole.c_u_px,
                       pinhole.c_v_px,
                       {kLens.k1, kLens.k2, kLens.p1, kLens.p2, kLens.k3}};
  Exposure exposure;
  exposure.X_BC.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  exposure.X_BC.translation() = Eigen::Vector3d(0.5, 0.0, 0.55);
  double sum2 = 0.0;
  double moved_px = 0.0;
  int count = 0;
  for (const double x : {-0.16, 0.0, 0.16}) {
    for (const double y : {-0.10, 0.0, 0.10}) {
      const Eigen::Vector3d p_CO_C(x, y, 0.45);
      exposure.p_BO = exposure.X_BC * p_CO_C;
      cv::Mat rgba(480, 640, CV_8UC4);
      optics.Draw(exposure, {rgba.data, rgba.total() * 4});
      cv::Mat bgr;
      cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
      vision::TargetDetector detector(config);
      const vision::Detection d = detector.Detect(bgr);
      ASSERT_TRUE(d.found) << "at " << p_CO_C.transpose();
      const model::Vec3 m = d.Middle();
      const double off = std::hypot(pinhole.U(m) - pinhole.U(p_CO_C), pinhole.V(m) - pinhole.V(p_CO_C));
      const Eigen::Vector2d seen = Distort(kLens, {x / 0.45, y / 0.45});
      moved_px = std::max(moved_px, pinhole.f_px * (seen - Eigen::Vector2d(x / 0.45, y / 0.45)).norm());
      sum2 += off * off;
      ++count;
    }
  }
  const double rms = std::sqrt(sum2 / count);
  std::cout << "the lens moves the ball by up to " << moved_px << " px; found " << rms << " px rms off\n";
  EXPECT_GT(moved_px, 5.0) << "the lens distorts too little for this test";
  EXPECT_LT(rms, 0.10);
}

}  // namespace
}  // namespace fovea::sim
