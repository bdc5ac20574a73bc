// SPDX-License-Identifier: Apache-2.0
// Evidence beside a triangle's sides and along their extensions, on ray-cast pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "firmware/vision/detect/target_detector.hpp"
#include "firmware/vision/fit/polygon_fit.hpp"
#include "firmware/vision/pose/flat_corners.hpp"
#include "tools/bench/vision/picture.hpp"
#include "tools/bench/vision/picture_target.hpp"

namespace fovea::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDistance = 0.5;  // of the triangle, which faces the camera
constexpr double kGround = 100.0;
constexpr double kContrast = 80.0;
constexpr double kLeast = 0.25 * kContrast;

DetectorConfig Triangle() { return bench::ConfigOf(bench::TargetKind::kTriangle, {}, FindBy::kGray); }

bench::Body Plate(const std::vector<Vector2d>& corners, double distance, double level) {
  bench::Body body;
  body.shape = bench::Shape::kPolygon;
  body.p = Vector3d(0.0, 0.0, distance);
  body.corners = corners;
  body.bgr.setConstant(level);
  return body;
}

bench::PictureScene SceneOf(const DetectorConfig& config, double level) {
  bench::PictureScene scene;
  scene.ground_bgr.setConstant(kGround);
  scene.noise = 3.0;
  scene.bodies = {Plate(FlatCorners(config.corners), kDistance, level)};
  return scene;
}

// A corner of the triangle's side `k` and the directions beyond it.
struct Beyond {
  Vector2d corner;
  Vector2d on;
  Vector2d inward;  // normal to the side, as long as `on`
};
Beyond BeyondOf(const DetectorConfig& config, std::size_t k, bool at_end) {
  const std::vector<Vector2d> corners = FlatCorners(config.corners);
  const Vector2d& a = corners[k];
  const Vector2d& b = corners[(k + 1) % corners.size()];
  const Vector2d side = b - a;
  return {at_end ? b : a, at_end ? side : Vector2d(-side), Vector2d(-side.y(), side.x())};
}

// A plate on the inner side of the extended side, from `from` to `to` side lengths beyond the corner.
bench::Body PlateBeyond(const Beyond& beyond, double from, double to, double level) {
  const Vector2d near = beyond.corner + from * beyond.on;
  const Vector2d far = beyond.corner + to * beyond.on;
  std::vector<Vector2d> corners{near, far, far + 0.3 * beyond.inward, near + 0.3 * beyond.inward};
  const Vector2d first = corners[1] - corners[0];
  if (first.x() * beyond.inward.y() - first.y() * beyond.inward.x() < 0.0) {
    std::reverse(corners.begin(), corners.end());
  }
  return Plate(corners, kDistance, level);
}

// Fits the triangle from its true corners; returns whether a side goes on beyond a corner.
bool GoesOn(const DetectorConfig& config, const bench::PictureScene& scene) {
  const cv::Mat image = Draw(scene);
  std::vector<ImagePoint> start;
  const std::vector<Vector2d> corners = FlatCorners(config.corners);
  start.reserve(corners.size());
  for (const Vector2d& corner : corners) {
    const Vector2d p = scene.camera.f_px / kDistance * corner;
    start.push_back({p.x() + scene.camera.c_u_px, p.y() + scene.camera.c_v_px});
  }
  PolygonFitter fitter(config.edge_noise, config.by == FindBy::kColour);
  const PolygonFit fit = fitter.Fit(image, config.intrinsics, start);
  EXPECT_TRUE(fit.converged);
  return fitter.evidence().SideGoesOn(image, config.intrinsics,
                                      std::span(fit.corners.corner).first(start.size()), kLeast);
}

// Calls `look` for both ends of each side, of a brighter and of a darker triangle.
template <class Look>
void ForEachEnd(Look look) {
  const DetectorConfig config = Triangle();
  for (const double contrast : {kContrast, -kContrast}) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const bool at_end : {false, true}) {
        look(config, contrast, BeyondOf(config, k, at_end));
      }
    }
  }
}

// The number of ends (of 12) at which a side seems to go on, with a plate from `from` to `to` side lengths
// beyond the corner whose contrast to the ground is `share` of the target's.
int CountThatGoOn(double from, double to, double share) {
  int found = 0;
  ForEachEnd([&](const DetectorConfig& config, double contrast, const Beyond& beyond) {
    bench::PictureScene scene = SceneOf(config, kGround + contrast);
    scene.bodies.push_back(PlateBeyond(beyond, from, to, kGround + share * contrast));
    found += GoesOn(config, scene) ? 1 : 0;
  });
  return found;
}

TEST(SideEvidenceTest, SideVisibleAgainBeyondTheCornerContinues) {
  EXPECT_EQ(CountThatGoOn(0.25, 0.7, 1.0), 12);
}

TEST(SideEvidenceTest, OppositeContrastIsNotTheSameSide) { EXPECT_EQ(CountThatGoOn(0.25, 0.7, -1.0), 0); }

TEST(SideEvidenceTest, EdgeFarBeyondTheCornerIsNotTheSameSide) {
  EXPECT_EQ(CountThatGoOn(0.65, 0.9, 1.0), 0);
}

// At the corner itself any contrast counts: it is the edge of a covering object.
TEST(SideEvidenceTest, EdgeContinuingAtTheCornerCountsWithAnyContrast) {
  EXPECT_EQ(CountThatGoOn(0.0, 0.4, -0.5), 12);
}

// A bar of the ground's brightness cuts off a smaller triangle of the same shape.
TEST(SideEvidenceTest, PieceBesideAGroundColouredBarIsNotTheTarget) {
  constexpr double kWrongPx = 2.0;
  constexpr double kNear = 0.98;  // the bar's distance over the triangle's
  constexpr double kThick = 0.12;
  const DetectorConfig config = Triangle();
  const std::vector<Vector2d> corners = FlatCorners(config.corners);
  int pictures = 0;
  int right = 0;
  int wrong = 0;
  for (const double contrast : {kContrast, -kContrast}) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const double from : {0.25, 0.35, 0.45}) {
        // Across the whole triangle, parallel to the side opposite to corner k.
        const Vector2d on = corners[(k + 1) % 3] - corners[k];
        const Vector2d back = corners[(k + 2) % 3] - corners[k];
        const Vector2d wide = 0.2 * (back - on);
        const double to = from + kThick;
        bench::PictureScene scene = SceneOf(config, kGround + contrast);
        scene.bodies.push_back(
            Plate({kNear * (corners[k] + from * on - wide), kNear * (corners[k] + to * on - wide),
                   kNear * (corners[k] + to * back + wide), kNear * (corners[k] + from * back + wide)},
                  kNear * kDistance, kGround));
        const Detection d = TargetDetector(config).Detect(Draw(scene));
        const double off_px = d.found ? OffOf(d, scene) : 0.0;
        ++pictures;
        right += d.found && off_px < kWrongPx ? 1 : 0;
        wrong += d.found && off_px > kWrongPx ? 1 : 0;
      }
    }
  }
  std::cout << right << " of " << pictures << " found correctly, " << wrong << " incorrectly\n";
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(right, pictures);
}

// A small triangle that faces the camera, and a bar in front of it whose edge crosses a side at a few
// degrees. Some lines hit the side's edge and some the bar's; the fit follows the longer edge.
struct Crossed {
  bench::PictureScene scene;
  std::vector<Vector2d> corners;  // [px]
  std::vector<ImagePoint> start;  // with errors of up to 1 px
};
Crossed MakeCrossed(unsigned seed) {
  constexpr double kNear = 0.98;
  std::mt19937 engine(seed);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  Crossed crossed;
  bench::PictureCamera& camera = crossed.scene.camera;
  camera.width_px = 160;
  camera.height_px = 140;
  camera.c_u_px = 80.0;
  camera.c_v_px = 70.0;
  const double scale = kDistance / camera.f_px;
  const double side_px = between(40.0, 85.0);
  const double turn = between(0.0, 2.0 * std::numbers::pi);
  std::vector<Vector2d> triangle;
  triangle.reserve(3);
  crossed.corners.reserve(3);
  crossed.start.reserve(3);
  for (int k = 0; k < 3; ++k) {
    const double angle = turn + 2.0 * std::numbers::pi / 3.0 * k;
    const Vector2d p = side_px / std::numbers::sqrt3 * Vector2d(std::cos(angle), std::sin(angle));
    triangle.emplace_back(scale * p);
    crossed.corners.emplace_back(p + Vector2d(camera.c_u_px, camera.c_v_px));
  }
  for (const Vector2d& p : crossed.corners) {
    const double u = p.x() + between(-1.0, 1.0);
    crossed.start.push_back({u, p.y() + between(-1.0, 1.0)});
  }
  // The bar's near edge starts on side 1 and turns slightly inward or outward.
  const Vector2d on = (triangle[2] - triangle[1]).normalized();
  const Vector2d inward(-on.y(), on.x());
  const double angle = between(-0.12, 0.12);
  const Vector2d edge = std::cos(angle) * on + std::sin(angle) * inward;
  const Vector2d deep = scale * between(4.0, 30.0) * Vector2d(edge.y(), -edge.x());
  const Vector2d from = triangle[1] + between(0.1, 0.9) * (triangle[2] - triangle[1]);
  const Vector2d to = from + 100.0 * scale * edge;
  crossed.scene.grid = 4;
  crossed.scene.noise = 3.0;
  crossed.scene.seed = seed;
  crossed.scene.ground_bgr.setConstant(kGround);
  crossed.scene.bodies = {Plate(triangle, kDistance, kGround + kContrast),
                          Plate({kNear * from, kNear * (from + deep), kNear * (to + deep), kNear * to},
                                kNear * kDistance, between(10.0, 250.0))};
  std::vector<Vector2d>& bar = crossed.scene.bodies.back().corners;
  const Vector2d a = bar[1] - bar[0];
  const Vector2d b = bar[2] - bar[1];
  if (a.x() * b.y() - a.y() * b.x() < 0.0) {
    std::reverse(bar.begin(), bar.end());
  }
  return crossed;
}

// For each scene: whether the fit is the target's, and the bends explained. Here a side's number of lines
// changes during the fit; the outliers and the colours must come from the same lines.
TEST(SideEvidenceTest, BendsAreExplainedOnlyByACorrectFit) {
  constexpr std::array<unsigned, 6> kRight{285, 3143, 3878, 3928, 5960, 6141};
  constexpr std::array<unsigned, 4> kWrong{3160, 4228, 4653, 7080};
  const auto look = [](unsigned seed, bool right) {
    const Crossed crossed = MakeCrossed(seed);
    const bench::PictureCamera& camera = crossed.scene.camera;
    const Intrinsics in{camera.width_px, camera.height_px, camera.f_px,
                        camera.f_px,     camera.c_u_px,    camera.c_v_px};
    PolygonFitter fitter(EdgeNoise{}, false);
    const PolygonFit fit = fitter.Fit(Draw(crossed.scene), in, crossed.start);
    double off_px = 0.0;
    for (std::size_t i = 0; i < crossed.corners.size(); ++i) {
      off_px = std::max(off_px, std::hypot(fit.corners.corner[i].u_px - crossed.corners[i].x(),
                                           fit.corners.corner[i].v_px - crossed.corners[i].y()));
    }
    std::cout << "scene " << seed << ": " << off_px << " px off, " << fit.least_on << " on a side's line, "
              << (fit.bends_explained ? "explained\n" : "not explained\n");
    EXPECT_TRUE(fit.converged);
    EXPECT_TRUE(right ? off_px < 0.5 : off_px > 2.0);
    EXPECT_EQ(fit.bends_explained, right);
  };
  for (const unsigned seed : kRight) {
    look(seed, true);
  }
  for (const unsigned seed : kWrong) {
    look(seed, false);
  }
}

}  // namespace
}  // namespace fovea::vision
