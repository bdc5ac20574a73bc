// SPDX-License-Identifier: Apache-2.0
// Poses of disc, square and triangle on ray-cast pictures, against the truth and their own covariance.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "firmware/vision/fit/polygon_fit.hpp"
#include "firmware/vision/pose/flat_corners.hpp"
#include "tools/bench/vision/picture.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

DetectorConfig ConfigOf(hal::FeatureKind kind) {
  const bench::PictureCamera camera;
  DetectorConfig config;
  config.LookFor(bench::TargetOf(kind));
  config.by = FindBy::kGray;
  config.intrinsics = {camera.width_px, camera.height_px, camera.f_px,
                       camera.f_px,     camera.c_u_px,    camera.c_v_px};
  return config;
}

bench::PictureScene SceneOf(const DetectorConfig& config, const model::Pose& X_CO, double noise,
                            unsigned seed) {
  bench::PictureScene scene;
  scene.noise = noise;
  scene.seed = seed;
  bench::Body body;
  body.p = X_CO.p;
  body.R = X_CO.R;
  if (config.kind == hal::FeatureKind::kCircle) {
    body.shape = bench::Shape::kDisc;
    body.radius = 0.5 * config.size;
  } else {
    body.shape = bench::Shape::kPolygon;
    body.corners = FlatCorners(config.corners);
  }
  scene.bodies.push_back(body);
  return scene;
}

struct Errors {
  int found = 0;
  int right = 0;  // poses on the right branch
  double mm2 = 0.0;
  double deg2 = 0.0;
  double chi2 = 0.0;  // over 6
};

// Poses tilted by up to `most_tilt` [rad], each from a single first image without a known last pose.
Errors MeasurePoses(hal::FeatureKind kind, double most_tilt, double most_turn, int count) {
  const DetectorConfig config = ConfigOf(kind);
  std::mt19937 engine(5);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  Errors errors;
  for (int i = 0; i < count; ++i) {
    const double about = uniform(0.0, 6.28);
    model::Pose X_CO;
    X_CO.R = model::RotationOf(uniform(0.0, most_tilt) * Vec3(std::cos(about), std::sin(about), 0.0)) *
             model::RotationOf(Vec3(0.0, 0.0, uniform(-most_turn, most_turn)));
    X_CO.p.z() = uniform(0.25, 0.5);
    X_CO.p.x() = X_CO.p.z() * uniform(-0.2, 0.2);
    X_CO.p.y() = X_CO.p.z() * uniform(-0.12, 0.12);
    TargetDetector detector(config);
    const Detection d =
        detector.Detect(bench::Draw(SceneOf(config, X_CO, 3.0, static_cast<unsigned>(i + 1))));
    if (!d.found) {
      continue;
    }
    ++errors.found;
    model::Vec6 e;
    e.head<3>() = d.pose[0].X_CO.p - X_CO.p;
    e.tail<3>() = model::RotationVector(d.pose[0].X_CO.R * X_CO.R.transpose());
    const double deg = e.tail<3>().norm() * 57.29578;
    if (deg > 2.0) {
      continue;
    }
    ++errors.right;
    errors.mm2 += 1e6 * e.head<3>().squaredNorm();
    errors.deg2 += deg * deg;
    errors.chi2 += e.dot(d.cov_pose.inverse() * e) / 6.0;
  }
  const double n = std::max(errors.right, 1);
  errors.mm2 /= n;
  errors.deg2 /= n;
  errors.chi2 /= n;
  std::cout << "found " << errors.found << ", right branch " << errors.right << " of " << count << "; "
            << std::sqrt(errors.mm2) << " mm, " << std::sqrt(errors.deg2) << " deg rms, chi2/6 "
            << errors.chi2 << "\n";
  return errors;
}

// Corners as acute as a triangle has them that is seen obliquely. Below 15 degrees the tip is blurred.
TEST(FlatDetectorTest, AcuteTrianglesAreFound) {
  DetectorConfig config = ConfigOf(hal::FeatureKind::kTriangle);
  for (const double angle_deg : {30.0, 20.0, 15.0}) {
    const double half = 0.12 * std::tan(0.5 * angle_deg / 57.29578);
    config.corners = features::MakeTriangle({-0.06, 0.0, 0.06, -half, 0.06, half});
    const Vec3 tip = config.corners.corners[0];
    int found = 0;
    double worst_px = 0.0;
    constexpr int kPictures = 12;
    for (int i = 0; i < kPictures; ++i) {
      model::Pose X_CO;
      X_CO.p = {0.0, 0.0, 0.35};
      X_CO.R = model::RotationOf(Vec3(0.0, 0.0, 0.5 * i));
      TargetDetector detector(config);
      const Detection d =
          detector.Detect(bench::Draw(SceneOf(config, X_CO, 3.0, static_cast<unsigned>(i + 1))));
      found += d.found ? 1 : 0;
      const Vec3 p = X_CO * tip;
      const double u = config.intrinsics.U(p);
      const double v = config.intrinsics.V(p);
      double nearest = 1e9;
      for (int k = 0; k < d.corner_count; ++k) {
        const ImagePoint& corner = d.corner[static_cast<std::size_t>(k)];
        nearest = std::min(nearest, std::hypot(corner.u_px - u, corner.v_px - v));
      }
      worst_px = d.found ? std::max(worst_px, nearest) : worst_px;
    }
    std::cout << angle_deg << " deg: found " << found << " of " << kPictures << ", tip off by at most "
              << worst_px << " px\n";
    EXPECT_EQ(found, kPictures);
    EXPECT_LT(worst_px, 0.5);
  }
}

TEST(FlatDetectorTest, SquarePosesAreAccurate) {
  const Errors e = MeasurePoses(hal::FeatureKind::kSquare, 0.6, 0.7, 30);
  EXPECT_EQ(e.found, 30);
  EXPECT_EQ(e.right, 30);
  EXPECT_LT(std::sqrt(e.mm2), 0.05);
  EXPECT_LT(std::sqrt(e.deg2), 0.08);
  EXPECT_LT(e.chi2, 1.0);
}

TEST(FlatDetectorTest, TrianglePosesAreAccurate) {
  const Errors e = MeasurePoses(hal::FeatureKind::kTriangle, 0.25, 3.0, 30);
  EXPECT_EQ(e.found, 30);
  EXPECT_GE(e.right, 20) << "without a last pose, three points are ambiguous";
  EXPECT_LT(std::sqrt(e.mm2), 0.5);
  EXPECT_LT(e.chi2, 3.0);
}

TEST(FlatDetectorTest, TiltedDiscCentreIsNotItsEllipseCentre) {
  const DetectorConfig config = ConfigOf(hal::FeatureKind::kCircle);
  double worst = 0.0;
  double worst_depth = 0.0;
  for (int i = 0; i < 12; ++i) {
    // The discs are parallel to the image plane, wherever they are in the picture.
    const int row = i / 4;
    const model::Pose X_CO{Mat3::Identity(), Vec3(0.02 * (i % 4 - 1.5), 0.02 * (row - 1.0), 0.25 + 0.02 * i)};
    TargetDetector detector(config);
    const Detection d =
        detector.Detect(bench::Draw(SceneOf(config, X_CO, 2.0, static_cast<unsigned>(i + 1))));
    ASSERT_TRUE(d.found);
    worst = std::max(
        worst, 554.256 * std::hypot(d.s[0] - X_CO.p.x() / X_CO.p.z(), d.s[1] - X_CO.p.y() / X_CO.p.z()));
    worst_depth = std::max(worst_depth, std::fabs(d.s[2] * X_CO.p.z() / config.size - 1.0));
  }
  std::cout << "centre, worst " << worst << " px; depth, worst " << 100.0 * worst_depth << " %\n";
  EXPECT_LT(worst, 0.35);
  EXPECT_LT(worst_depth, 0.001);

  // The pose of a tilted disc from its exact ellipse.
  const Mat3 tilt = model::RotationOf(Vec3(0.6, 0.0, 0.0));
  std::array<DiscPose, 2> poses;
  const model::Pose X_CO{tilt, Vec3(0.03, -0.02, 0.4)};
  Eigen::Matrix3d H;  // maps the disc's plane [radii] to pixels
  const Intrinsics& in = config.intrinsics;
  Eigen::Matrix3d K;
  K << in.f_u_px, 0.0, in.c_u_px, 0.0, in.f_v_px, in.c_v_px, 0.0, 0.0, 1.0;
  H << 0.04 * X_CO.R.col(0), 0.04 * X_CO.R.col(1), X_CO.p;
  const Eigen::Matrix3d G = (K * H).inverse();
  const Eigen::Matrix3d conic = G.transpose() * Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal() * G;
  ASSERT_TRUE(PosesOfDisc(conic, in, 0.08, 0.0, poses));
  const double off = std::min((poses[0].p_CO_C - X_CO.p).norm(), (poses[1].p_CO_C - X_CO.p).norm());
  std::cout << "a disc's pose from its exact conic: off " << off << " m\n";
  EXPECT_LT(off, 1e-9);
}

// Three corners fit up to six poses. A pose out of reach does not exclude the others.
TEST(FlatDetectorTest, TrianglePosesOutOfReachAreDropped) {
  const model::Pose X_CO{model::RotationOf({-0.001, 0.7353, -0.2209}), {-0.3394, -0.1787, 0.7283}};
  const auto poses_within = [&](double distance_max) {
    DetectorConfig config = ConfigOf(hal::FeatureKind::kTriangle);
    config.distance_max = distance_max;
    TargetDetector detector(config);
    return detector.Detect(bench::Draw(SceneOf(config, X_CO, 3.0, 1)));
  };
  const Detection all = poses_within(3.0);
  ASSERT_TRUE(all.found);
  ASSERT_GT(all.pose[0].X_CO.p.norm(), 0.9) << "the test needs a pose out of reach";
  const Detection d = poses_within(0.9);
  ASSERT_TRUE(d.found);
  EXPECT_LT(d.pose_count, all.pose_count);
  double nearest_deg = 180.0;
  for (int i = 0; i < d.pose_count; ++i) {
    const model::Pose& pose = d.pose[static_cast<std::size_t>(i)].X_CO;
    EXPECT_LE(pose.p.norm(), 0.9);
    nearest_deg = std::min(nearest_deg, 57.3 * model::RotationVector(pose.R * X_CO.R.transpose()).norm());
  }
  std::cout << "nearest pose of the triangle in reach is off by " << nearest_deg << " deg\n";
  EXPECT_LT(nearest_deg, 0.3);
  EXPECT_FALSE(poses_within(0.3).found);
}

// A wall whose edge runs beside a side of a red square, lighter or darker than the ground: the target's
// colour tells its side from the border of two grays, which would pull the side towards it.
TEST(FlatDetectorTest, BorderOfTwoGroundsBesideASideDoesNotShiftIt) {
  constexpr double kFar = 0.5;   // of the square, which faces the camera [m]
  constexpr double kWall = 0.8;  // of the wall [m]
  const DetectorConfig config = ConfigOf(hal::FeatureKind::kSquare);
  double most_px = 0.0;
  for (const double wall : {60.0, 180.0}) {
    for (const double beside_px : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
      const model::Pose X_CO{Mat3::Identity(), {0.0, 0.0, kFar}};
      bench::PictureScene scene = SceneOf(config, X_CO, 2.0, 7);
      const bench::PictureCamera& camera = scene.camera;
      scene.gray = false;
      scene.ground_bgr.setConstant(120.0);
      scene.bodies.front().bgr = {50.0, 50.0, 190.0};
      const std::vector<Eigen::Vector2d> corners = FlatCorners(config.corners);
      double right = 0.0;
      for (const Eigen::Vector2d& corner : corners) {
        right = std::max(right, corner.x());
      }
      const double edge = kWall * (right / kFar + beside_px / camera.f_px);
      bench::Body body;
      body.shape = bench::Shape::kPolygon;
      body.p = Vec3(0.0, 0.0, kWall);
      body.corners = {{edge, -2.0}, {edge + 2.0, -2.0}, {edge + 2.0, 2.0}, {edge, 2.0}};
      body.bgr.setConstant(wall);
      scene.bodies.push_back(body);
      std::vector<ImagePoint> start;
      start.reserve(corners.size());
      for (const Eigen::Vector2d& corner : corners) {
        start.push_back({camera.c_u_px + camera.f_px / kFar * corner.x(),
                         camera.c_v_px + camera.f_px / kFar * corner.y()});
      }
      PolygonFitter fitter(config.edge_noise, true);
      const PolygonFit fit = fitter.Fit(Draw(scene), config.intrinsics, start);
      ASSERT_TRUE(fit.converged) << beside_px << " px beside";
      for (std::size_t k = 0; k < start.size(); ++k) {
        most_px = std::max(most_px, std::hypot(fit.corners.corner[k].u_px - start[k].u_px,
                                               fit.corners.corner[k].v_px - start[k].v_px));
      }
    }
  }
  std::cout << "corners at most " << most_px << " px off\n";
  EXPECT_LT(most_px, 0.2);
}

}  // namespace
}  // namespace fovea::vision
