// SPDX-License-Identifier: Apache-2.0
// Poses of three and four corners compared with OpenCV's P3P and IPPE.
#include "firmware/vision/pose/three_points.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <opencv2/calib3d.hpp>
#include <random>
#include <vector>

#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/pose/flat_pose.hpp"

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

class Chance {
 public:
  double Between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  double Normal() { return normal_(engine_); }
  // Separate statements, so that every compiler draws in the same order.
  model::Pose Pose(double most_tilt) {
    const double about = Between(0.0, 6.28);
    const double tilt = Between(0.0, most_tilt);
    const double turn = Between(-3.1, 3.1);
    model::Pose X_CO;
    X_CO.R = model::RotationOf(tilt * Vec3(std::cos(about), std::sin(about), 0.0)) *
             model::RotationOf(Vec3(0.0, 0.0, turn));
    X_CO.p.z() = Between(0.25, 0.9);
    X_CO.p.x() = X_CO.p.z() * Between(-0.3, 0.3);
    X_CO.p.y() = X_CO.p.z() * Between(-0.2, 0.2);
    return X_CO;
  }

 private:
  std::mt19937 engine_{11};
  std::normal_distribution<double> normal_;
};

std::vector<model::Pose> PosesOf(const std::vector<cv::Mat>& rotations,
                                 const std::vector<cv::Mat>& positions) {
  std::vector<model::Pose> poses;
  poses.reserve(rotations.size());
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const cv::Mat& w = rotations[i];
    const cv::Mat& t = positions[i];
    poses.push_back({model::RotationOf(Vec3(w.at<double>(0), w.at<double>(1), w.at<double>(2))),
                     Vec3(t.at<double>(0), t.at<double>(1), t.at<double>(2))});
  }
  return poses;
}

double TurnBetween(const Mat3& a, const Mat3& b) { return model::RotationVector(a * b.transpose()).norm(); }

TEST(ThreePointsTest, FindsTheTruePoseAndEveryPoseOfOpenCv) {
  Chance chance;
  const std::array<Vec3, 3> points{Vec3(-0.047, 0.037, 0.0), Vec3(0.063, 0.027, 0.0),
                                   Vec3(-0.017, -0.063, 0.0)};
  constexpr int kPoses = 2000;
  int of_opencv = 0;
  int missed = 0;
  double worst_m = 0.0;
  for (int i = 0; i < kPoses; ++i) {
    const model::Pose X_CO = chance.Pose(0.9);
    std::array<Vec3, 3> rays;
    std::vector<cv::Point3d> object;
    std::vector<cv::Point2d> seen;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const Vec3 p = X_CO * points[k];
      rays[k] = p.normalized();
      object.emplace_back(points[k].x(), points[k].y(), 0.0);
      seen.emplace_back(p.x() / p.z(), p.y() / p.z());
    }
    const ThreePointPoses found = PosesOfThreePoints(points, rays);
    const auto nearest_m = [&](const model::Pose& pose) {
      double nearest = 1e9;
      for (const model::Pose& ours : std::span(found.X_CO).first(static_cast<std::size_t>(found.count))) {
        nearest = std::min(nearest, (ours.p - pose.p).norm() + 0.05 * TurnBetween(ours.R, pose.R));
      }
      return nearest;
    };
    worst_m = std::max(worst_m, nearest_m(X_CO));
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> positions;
    cv::solveP3P(object, seen, cv::Matx33d::eye(), cv::noArray(), rotations, positions, cv::SOLVEPNP_P3P);
    for (const model::Pose& theirs : PosesOf(rotations, positions)) {
      // Some of OpenCV's poses lie behind the camera or do not fit at all.
      bool is_one = true;
      for (std::size_t k = 0; k < rays.size(); ++k) {
        is_one = is_one && (theirs * points[k]).normalized().dot(rays[k]) > 1.0 - 1e-12;
      }
      of_opencv += is_one ? 1 : 0;
      missed += is_one && nearest_m(theirs) > 1e-3 ? 1 : 0;
    }
  }
  std::cout << "true pose off by at most " << worst_m << " m; of OpenCV's " << of_opencv << " poses "
            << missed << " missed\n";
  EXPECT_LT(worst_m, 1e-7);
  EXPECT_GT(of_opencv, kPoses);
  EXPECT_EQ(missed, 0);
}

// Poses at which the formula for the second distance is nearly 0/0.
TEST(ThreePointsTest, FindsTheTruePoseWhereTheFormulaIsIllConditioned) {
  Chance chance;
  const std::array<Vec3, 3> points{Vec3(-0.047, 0.037, 0.0), Vec3(0.063, 0.027, 0.0),
                                   Vec3(-0.017, -0.063, 0.0)};
  int tried = 0;
  double worst_m = 0.0;
  while (tried < 100) {
    const model::Pose X_CO = chance.Pose(0.9);
    std::array<Vec3, 3> rays;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      rays[k] = (X_CO * points[k]).normalized();
    }
    const double v = (X_CO * points[2]).norm() / (X_CO * points[0]).norm();
    if (std::fabs(rays[0].dot(rays[1]) - v * rays[1].dot(rays[2])) > 2e-5) {
      continue;
    }
    ++tried;
    double nearest_m = 1e9;
    const ThreePointPoses found = PosesOfThreePoints(points, rays);
    for (const model::Pose& ours : std::span(found.X_CO).first(static_cast<std::size_t>(found.count))) {
      nearest_m = std::min(nearest_m, (ours.p - X_CO.p).norm() + 0.05 * TurnBetween(ours.R, X_CO.R));
    }
    worst_m = std::max(worst_m, nearest_m);
  }
  std::cout << "true pose off by at most " << worst_m << " m, in " << tried << " poses\n";
  EXPECT_LT(worst_m, 1e-10);
}

TEST(ThreePointsTest, SquarePosesMatchIppeOrFitBetter) {
  Chance chance;
  const std::vector<Eigen::Vector2d> shape{{-0.04, -0.04}, {0.04, -0.04}, {0.04, 0.04}, {-0.04, 0.04}};
  const Intrinsics in{640, 480, 554.256, 554.256, 319.5, 239.5};
  constexpr int kPoses = 1000;
  constexpr double kNoisePx = 0.3;
  constexpr double kOther = 0.1;  // [rad]
  constexpr double kSame = 0.02;
  int worse = 0;
  int missed = 0;
  int seconds = 0;
  for (int i = 0; i < kPoses; ++i) {
    const model::Pose X_CO = chance.Pose(0.5);
    CornerFit fit;
    fit.count = 4;
    fit.cov = CornerFit::Covariance::Identity(8, 8) * (kNoisePx * kNoisePx);
    std::vector<cv::Point3d> object;
    std::vector<cv::Point2d> seen;
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const Vec3 p = X_CO * Vec3(shape[k].x(), shape[k].y(), 0.0);
      fit.corner[k] = {in.U(p) + kNoisePx * chance.Normal(), in.V(p) + kNoisePx * chance.Normal()};
      const Vec3 ray = in.Ray(fit.corner[k].u_px, fit.corner[k].v_px);
      object.emplace_back(shape[k].x(), shape[k].y(), 0.0);
      seen.emplace_back(ray.x(), ray.y());
    }
    const auto off_px = [&](const model::Pose& pose) {
      double sum2 = 0.0;
      for (std::size_t k = 0; k < shape.size(); ++k) {
        const Vec3 p = pose * Vec3(shape[k].x(), shape[k].y(), 0.0);
        sum2 += std::pow(in.U(p) - fit.corner[k].u_px, 2) + std::pow(in.V(p) - fit.corner[k].v_px, 2);
      }
      return std::sqrt(sum2 / 4.0);
    };
    const CornerPoses ours = PosesOfCorners(fit, in, shape, 4, nullptr);
    const auto poses = std::span(ours.pose).first(static_cast<std::size_t>(ours.count));
    double least_px = 1e9;
    for (const CornerPose& pose : poses) {
      least_px = std::min(least_px, pose.off_px);
    }
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> positions;
    cv::solvePnPGeneric(object, seen, cv::Matx33d::eye(), cv::noArray(), rotations, positions, false,
                        cv::SOLVEPNP_IPPE);
    worse += off_px(PosesOf(rotations, positions).front()) < least_px - 1e-6 ? 1 : 0;
    // IPPE's second pose counts if it fits within the noise and IPPE's own refinement stays there.
    cv::solvePnPRefineLM(object, seen, cv::Matx33d::eye(), cv::noArray(), rotations[1], positions[1]);
    const model::Pose second = PosesOf(rotations, positions)[1];
    if (off_px(second) < 2.0 * kNoisePx &&
        TurnBetween(second.R, PosesOf(rotations, positions)[0].R) > kOther) {
      ++seconds;
      missed += std::none_of(poses.begin(), poses.end(), [&](const CornerPose& pose) {
        return pose.X_CO.R.col(2).cross(second.R.col(2)).norm() < kSame;
      });
    }
  }
  std::cout << worse << " of " << kPoses << " fit worse than IPPE's; of " << seconds
            << " second poses within the noise, " << missed << " missed\n";
  EXPECT_EQ(worse, 0);
  EXPECT_GE(seconds, 50);
  EXPECT_LE(missed, 2) << "except where the corners hardly determine the tilt";
}

// The detector may name any corner first: the pose is the true one or one of its symmetric turns.
TEST(PosesOfCornersTest, SymmetricTurnsAreOnePoseAndOthersAreDistinct) {
  const double r = 0.05;
  const double h = r * std::sqrt(0.75);
  const Intrinsics in{640, 480, 554.256, 554.256, 319.5, 239.5};
  struct Case {
    const char* name;
    std::vector<Eigen::Vector2d> shape;
    int turns;
  };
  for (const Case& c : {Case{"square", {{-r, -r}, {r, -r}, {r, r}, {-r, r}}, 4},
                        Case{"rectangle", {{-r, -0.6 * r}, {r, -0.6 * r}, {r, 0.6 * r}, {-r, 0.6 * r}}, 2},
                        Case{"kite", {{-r, -0.8 * r}, {0.9 * r, -0.5 * r}, {r, r}, {-0.9 * r, 0.3 * r}}, 1},
                        Case{"equilateral triangle", {{0.0, -r}, {h, 0.5 * r}, {-h, 0.5 * r}}, 3}}) {
    Chance chance;
    const auto n = static_cast<int>(c.shape.size());
    // Two poses of three corners may nearly coincide; poses within 0.01 rad are listed once.
    const double most_rad = n == 3 ? 0.01 : 1e-6;
    double worst_rad = 0.0;
    double worst_px = 0.0;
    for (int i = 0; i < 300; ++i) {
      const model::Pose X_CO = chance.Pose(0.5);
      const int shift = i % n;
      CornerFit fit;
      fit.count = n;
      fit.cov = CornerFit::Covariance::Identity(2 * n, 2 * n) * 1e-4;
      const auto pixel = [&](const model::Pose& pose, int k) {
        const Eigen::Vector2d& corner = c.shape[static_cast<std::size_t>(k)];
        const Vec3 p = pose * Vec3(corner.x(), corner.y(), 0.0);
        return Eigen::Vector2d(in.U(p), in.V(p));
      };
      for (int k = 0; k < n; ++k) {
        const Eigen::Vector2d at = pixel(X_CO, (k + shift) % n);
        fit.corner[static_cast<std::size_t>(k)] = {at.x(), at.y()};
      }
      const CornerPoses found = PosesOfCorners(fit, in, c.shape, c.turns, nullptr);
      ASSERT_GT(found.count, 0) << c.name;
      double nearest_rad = 1e9;
      for (const CornerPose& pose : std::span(found.pose).first(static_cast<std::size_t>(found.count))) {
        for (int turn = 0; turn < c.turns; ++turn) {
          const Mat3 R = X_CO.R * model::RotationOf({0.0, 0.0, 2.0 * M_PI * turn / c.turns});
          nearest_rad = std::min(nearest_rad, TurnBetween(pose.X_CO.R, R));
        }
        for (int k = 0; k < n; ++k) {
          const ImagePoint& seen = fit.corner[static_cast<std::size_t>((pose.first + k) % n)];
          const Eigen::Vector2d off = pixel(pose.X_CO, k) - Eigen::Vector2d(seen.u_px, seen.v_px);
          worst_px = std::max(worst_px, off.norm());
        }
      }
      worst_rad = std::max(worst_rad, nearest_rad);
      const CornerPoses tracked = PosesOfCorners(fit, in, c.shape, c.turns, &X_CO);
      ASSERT_GT(tracked.count, 0) << c.name;
      EXPECT_LT(TurnBetween(tracked.pose[0].X_CO.R, X_CO.R), most_rad) << c.name << ": as before";
      EXPECT_EQ(tracked.pose[0].first, (n - shift) % n) << c.name;
    }
    std::cout << c.name << ": true pose off by at most " << worst_rad << " rad; corners off by at most "
              << worst_px << " px\n";
    EXPECT_LT(worst_rad, most_rad) << c.name;
    EXPECT_LT(worst_px, 0.2) << c.name;
  }
}

}  // namespace
}  // namespace fovea::vision
