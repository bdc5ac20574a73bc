// What stands beside a triangle's sides and in line with them, on ray-cast pictures.
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
  scene.bodies = {Plate(CornersOf(config), kDistance, level)};
  return scene;
}

// Of side `k` of the triangle: where its corner is, which way is on beyond it and which is inward.
struct Beyond {
  Vector2d corner;
  Vector2d on;
  Vector2d inward;  // both of the side's length
};
Beyond BeyondOf(const DetectorConfig& config, std::size_t k, bool at_end) {
  const std::vector<Vector2d> corners = CornersOf(config);
  const Vector2d& a = corners[k];
  const Vector2d& b = corners[(k + 1) % corners.size()];
  const Vector2d side = b - a;
  return {at_end ? b : a, at_end ? side : Vector2d(-side), Vector2d(-side.y(), side.x())};
}

// A plate on the inner side of the line that goes on beyond a corner, in shares of the side.
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

// Fits the triangle where it is and asks whether a side goes on.
bool GoesOn(const DetectorConfig& config, const bench::PictureScene& scene) {
  const cv::Mat image = Draw(scene);
  std::vector<ImagePoint> start;
  const std::vector<Vector2d> corners = CornersOf(config);
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

// Calls `look` with each corner and each side that ends there, of a brighter and of a darker triangle.
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

// Of the 12 ends, at how many the side is seen to go on where a plate begins `from` and ends `to` sides
// beyond, which differs from the ground by `share` of the target's contrast.
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

// Right at the corner any contrast tells: it is the edge of what hides.
TEST(SideEvidenceTest, EdgeContinuingAtTheCornerCountsWithAnyContrast) {
  EXPECT_EQ(CountThatGoOn(0.0, 0.4, -0.5), 12);
}

// A bar as bright as the ground leaves a piece of the triangle's own shape beside it.
TEST(SideEvidenceTest, PieceBesideAGroundColouredBarIsNotTheTarget) {
  constexpr double kWrongPx = 2.0;
  constexpr double kNear = 0.98;  // the bar's distance, in the triangle's
  constexpr double kThick = 0.12;
  const DetectorConfig config = Triangle();
  const std::vector<Vector2d> corners = CornersOf(config);
  int pictures = 0;
  int right = 0;
  int wrong = 0;
  for (const double contrast : {kContrast, -kContrast}) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const double from : {0.25, 0.35, 0.45}) {
        // Across all of it, in parallel to the side that is opposite to corner k.
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
  std::cout << right << " of " << pictures << " found rightly, " << wrong << " wrongly\n";
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(right, pictures);
}

// A small triangle that faces the camera, and before it a bar whose edge crosses a side at some degrees:
// lines there meet the one edge or the other, and the fit follows the longer one.
struct Crossed {
  bench::PictureScene scene;
  std::vector<Vector2d> corners;  // [px]
  std::vector<ImagePoint> start;  // up to 1 px off
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
  // The bar's near edge begins on side 1 and goes a little inward or outward from it.
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

// Of each: whether the fit is the target's, and so the bends explained. A side of these gets another number
// of lines as the fit moves its corners: what is off and what stands beside must be of the same lines.
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
