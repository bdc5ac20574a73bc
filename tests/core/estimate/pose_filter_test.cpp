// SPDX-License-Identifier: Apache-2.0
// A flat target's pose from its corners: exact for its motion model, with a consistent covariance.
#include "firmware/core/estimate/pose_filter.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "tests/core/estimate/corner_views.hpp"

namespace fovea::estimate {
namespace {

TEST(PoseFilterTest, FollowsAConstantMotionExactly) {
  const config::PredictConfig config;
  for (const Polygon& polygon :
       {features::MakeTriangle(features::kDefaultTriangle), features::MakeSquare(0.08)}) {
    Draw draw(1);
    PoseFilter filter;
    const Vec3 v(0.05, -0.03, 0.01);
    const Vec3 w(0.2, -0.1, 0.4);
    const auto truth = [&](double t) { return Pose{Turned(w * t) * kOnTable.R, kOnTable.p + v * t}; };
    const CornerView first = ViewOf(polygon, CameraAt(0.0), truth(0.0), 0, 0.0, draw);
    ASSERT_TRUE(StartPose(polygon, first, first.seen.branches[0], filter));
    double distance2 = 0.0;
    for (int k = 1; k < 90; ++k) {
      // Vision may begin with another corner in each image.
      const CornerView view =
          ViewOf(polygon, CameraAt(k * kFrameS), truth(k * kFrameS), k, 0.0, draw, k % polygon.num_corners);
      ASSERT_TRUE(UpdatePose(config, polygon, view, filter, distance2)) << k << ": " << distance2;
    }
    const std::int64_t now = 89 * kFrameNs + 70'000'000;
    const FlatMotion motion = MotionAt(config::PredictConfig{}, filter, now);
    const Pose there = truth(1e-9 * static_cast<double>(now));
    const double off_m = (motion.X_BO.p - there.p).norm();
    const double off_rad = Between(motion.X_BO.R, there.R).norm();
    std::cout << polygon.num_corners << " corners, 70 ms ahead: off by " << off_m << " m, " << off_rad
              << " rad; rates by " << (motion.v_BO_B - v).norm() << " m/s, " << (motion.w_BO_B - w).norm()
              << " rad/s\n";
    EXPECT_LT(off_m, 1e-6);
    EXPECT_LT(off_rad, 1e-5);
  }
}

// Rolling shutter: each filter adds the target's motion by its own velocity, so it follows without an error.
TEST(PoseFilterTest, FollowsAConstantMotionUnderARollingShutter) {
  config::PredictConfig config;
  config.gate_sigma = 1e6;  // without the model the views are outliers
  for (const Polygon& polygon :
       {features::MakeTriangle(features::kDefaultTriangle), features::MakeSquare(0.08)}) {
    Draw draw(1);
    const Vec3 v(0.05, -0.06, 0.01);
    const Vec3 w(0.2, -0.1, 0.4);
    const auto truth = [&](double t) { return Pose{Turned(w * t) * kOnTable.R, kOnTable.p + v * t}; };
    double off_m[2] = {0.0, 0.0};
    for (const bool is_modelled : {false, true}) {
      PoseFilter filter;
      double distance2 = 0.0;
      for (int k = 0; k < 90; ++k) {
        CornerView view =
            ViewOf(polygon, CameraAt(k * kFrameS), truth(k * kFrameS), k, 0.0, draw, k % polygon.num_corners);
        RollRows(polygon, 30e-6 * kFocalPx, truth(k * kFrameS), v, w, view);
        view.row_time = is_modelled ? view.row_time : 0.0;
        if (k == 0) {
          ASSERT_TRUE(StartPose(polygon, view, view.seen.branches[0], filter));
        } else {
          ASSERT_TRUE(UpdatePose(config, polygon, view, filter, distance2)) << k << ": " << distance2;
        }
      }
      off_m[is_modelled ? 1 : 0] = (filter.X_BO.p - truth(89 * kFrameS).p).norm();
    }
    std::cout << polygon.num_corners << " corners: off by " << off_m[1] << " m, without the model by "
              << off_m[0] << " m\n";
    EXPECT_GT(off_m[0], 5e-5) << "the shutter is too quick for this test";
    EXPECT_LT(off_m[1], 5e-6);  // of second order in the time of the rows
  }
}

// Mean normalised squared error of pose and rates over many runs: it equals their dimension if the covariance
// is right. The camera moves; the target moves and turns at random, as its model assumes. Above the triangle
// the camera stays inside the cylinder through its corners: on that cylinder two poses coincide, and no image
// shows with which of them a freely moving target goes on.
class PoseFilterConsistencyTest : public testing::TestWithParam<double> {};

TEST_P(PoseFilterConsistencyTest, CovarianceIsRightForATargetOfItsModel) {
  const double row_time = GetParam();
  config::PredictConfig config;
  config.target_jerk = 0.3;
  config.gate_sigma = 100.0;
  constexpr double kMean = 0.1;
  constexpr double kSigmaPx = 0.05;
  for (const Polygon& polygon :
       {features::MakeTriangle(features::kDefaultTriangle), features::MakeSquare(0.08)}) {
    Draw draw(12);
    config.target_turn = polygon.num_corners == 3 ? 0.02 : 0.1;
    double pose = 0.0;
    double all = 0.0;
    constexpr int kRuns = 300;
    for (int run = 0; run < kRuns; ++run) {
      const double t0 = draw.Between(0.0, 20.0);
      const double swing = polygon.num_corners == 3 ? 0.1 : 1.0;
      Pose X{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.0, 0.02}};
      Vec3 v = 0.01 * draw.Vector();
      Vec3 a = 0.01 * draw.Vector();
      Vec3 w = 0.01 * draw.Vector();
      PoseFilter filter;
      const CornerView first = ViewOf(polygon, CameraAt(t0, swing), X, 0, kSigmaPx, draw);
      ASSERT_TRUE(StartPose(polygon, first, first.seen.branches[0], filter));
      double distance2 = 0.0;
      for (int k = 1; k < 40; ++k) {
        constexpr int kSteps = 33;
        const double dt = kFrameS / kSteps;
        for (int i = 0; i < kSteps; ++i) {
          const Vec3 a0 = a;
          const Vec3 v0 = v;
          const Vec3 w0 = w;
          a += std::sqrt(config.target_jerk * config.target_jerk * kMean * dt) * draw.Vector();
          w += std::sqrt(config.target_turn * config.target_turn * kMean * dt) * draw.Vector();
          v += 0.5 * dt * (a + a0);
          X.p += 0.5 * dt * (v + v0);
          X.R = Turned(0.5 * dt * (w + w0)) * X.R;
        }
        const Pose X_BC = CameraAt(t0 + k * kFrameS, swing);
        const Pose off{Turned(kCameraTurnSigma * draw.Vector()), kCameraShiftSigma * draw.Vector()};
        CornerView view = ViewOf(polygon, X_BC * off, X, k, kSigmaPx, draw);
        view.X_CB = X_BC.Inverse();
        if (row_time > 0.0) {
          RollRows(polygon, row_time, X, v, w, view);
        }
        ASSERT_TRUE(UpdatePose(config, polygon, view, filter, distance2));
      }
      Eigen::Matrix<double, 15, 1> e;
      e << X.p - filter.X_BO.p, Between(X.R, filter.X_BO.R), v - filter.v_BO_B, a - filter.a_BO_B,
          w - filter.w_BO_B;
      const Eigen::Matrix<double, 15, 15> P = filter.P.topLeftCorner<15, 15>();  // without the stamps' error
      const Eigen::Matrix<double, 6, 6> P_pose = P.topLeftCorner<6, 6>();
      EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
      all += e.dot(P.inverse() * e);
      pose += e.head<6>().dot(P_pose.inverse() * e.head<6>());
    }
    std::cout << polygon.num_corners << " corners: mean normalised squared error of the pose " << pose / kRuns
              << ", expected 6; of all " << all / kRuns << ", expected 15\n";
    EXPECT_NEAR(pose / kRuns, 6.0, 1.0);  // standard deviation sqrt(12 / 300) = 0.2
    EXPECT_NEAR(all / kRuns, 15.0, 1.6);  // and sqrt(30 / 300) = 0.3
  }
}

INSTANTIATE_TEST_SUITE_P(Shutters, PoseFilterConsistencyTest, testing::Values(0.0, 30e-6 * kFocalPx),
                         [](const auto& given) { return given.param > 0.0 ? "rolling" : "global"; });

// A wrong focal length enlarges a picture. A near, tilted square then has a shape that fits no pose. Its
// views are taken if the gate knows how wrong the focal length may be; a corner in a wrong place is still an
// outlier.
TEST(PoseFilterTest, AWrongFocalLengthIsNoOutlier) {
  const Polygon square = features::MakeSquare(0.10);
  const Pose X_BO{Turned({0.4, 0.3, 0.2}), {0.02, -0.03, 0.25}};
  constexpr int kViews = 180;
  int rejected[2] = {0, 0};
  for (const bool knows : {false, true}) {
    config::PredictConfig config;
    config.scale_sigma = knows ? 0.02 : 1e-9;
    Draw draw(4);
    PoseFilter filter;
    double distance2 = 0.0;
    for (int k = 0; k < kViews; ++k) {
      CornerView view = ViewOf(square, Pose{Mat3::Identity(), Vec3::Zero()}, X_BO, k, 0.03, draw);
      view.seen.xy *= 1.0 + 0.02 * std::min(1.0, k / (0.5 * kViews));  // the pose follows, the shape cannot
      if (k == 0) {
        ASSERT_TRUE(StartPose(square, view, view.seen.branches[0], filter));
      } else {
        rejected[knows ? 1 : 0] += UpdatePose(config, square, view, filter, distance2) ? 0 : 1;
      }
    }
    CornerView wrong = ViewOf(square, Pose{Mat3::Identity(), Vec3::Zero()}, X_BO, kViews, 0.03, draw);
    wrong.seen.xy *= 1.02;
    wrong.seen.xy[3] += 8.0 / kFocalPx;
    EXPECT_FALSE(UpdatePose(config, square, wrong, filter, distance2)) << std::sqrt(distance2) << " sigma";
  }
  std::cout << "rejected of " << kViews - 1 << " views: " << rejected[0] << ", and " << rejected[1]
            << " with the doubt\n";
  EXPECT_GT(rejected[0], 30);
  EXPECT_EQ(rejected[1], 0);
}

// The views have a common lateness, which drifts by a millisecond (1 sigma) in a second: the camera was
// elsewhere than at their stamps. The filter finds it from the camera's own motion, and its variance is
// right.
TEST(PoseFilterTest, MovingCameraShowsTheViewsLateness) {
  config::PredictConfig config;
  config.target_jerk = 0.02;  // of a target that may jerk more, one cannot tell its motion from wrong stamps
  config.target_turn = 0.02;
  config.gate_sigma = 100.0;
  constexpr double kSigmaPx = 0.05;
  constexpr double kMean = 0.1;
  constexpr double kQuick = 3.0;  // the camera moves this much faster than in the other tests
  constexpr int kRuns = 300;
  const Polygon polygon = features::MakeSquare(0.08);
  Draw draw(14);
  double nees = 0.0;
  double before2 = 0.0;
  double after2 = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const double t0 = draw.Between(0.0, 20.0);
    double late = config.stamp_sigma * draw.Normal();
    Pose X{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.0, 0.02}};
    Vec3 v = 0.01 * draw.Vector();
    Vec3 a = 0.01 * draw.Vector();
    Vec3 w = 0.01 * draw.Vector();
    PoseFilter filter;
    for (int k = 0; k < 60; ++k) {
      const Pose off{Turned(kCameraTurnSigma * draw.Vector()), kCameraShiftSigma * draw.Vector()};
      CornerView view =
          ViewOf(polygon, CameraAt(kQuick * (t0 + k * kFrameS - late)) * off, X, k, kSigmaPx, draw);
      view.late = filter.late;
      view.late_sigma = config.stamp_sigma;
      const double believed_s = t0 + k * kFrameS - view.late;
      constexpr double kStep = 1e-4;
      const Pose X_BC = CameraAt(kQuick * believed_s);
      const Pose before = CameraAt(kQuick * (believed_s - kStep));
      const Pose after = CameraAt(kQuick * (believed_s + kStep));
      view.X_CB = X_BC.Inverse();
      view.V_BC_C << X_BC.R.transpose() * (after.p - before.p) / (2.0 * kStep),
          X_BC.R.transpose() * Between(after.R, before.R) / (2.0 * kStep);
      double distance2 = 0.0;
      if (k == 0) {
        ASSERT_TRUE(StartPose(polygon, view, view.seen.branches[0], filter));
      } else {
        ASSERT_TRUE(UpdatePose(config, polygon, view, filter, distance2));
      }
      if (k == 59) {
        break;
      }
      constexpr int kSteps = 33;
      const double dt = kFrameS / kSteps;
      for (int i = 0; i < kSteps; ++i) {
        a += std::sqrt(config.target_jerk * config.target_jerk * kMean * dt) * draw.Vector();
        w += std::sqrt(config.target_turn * config.target_turn * kMean * dt) * draw.Vector();
        v += dt * a;
        X.p += dt * v;
        X.R = Turned(dt * w) * X.R;
      }
      late += std::sqrt(1e-6 * kFrameS) * draw.Normal();
    }
    const double error = filter.late - late;
    nees += error * error / filter.P(PoseFilter::kLate, PoseFilter::kLate) / kRuns;
    before2 += late * late / kRuns;
    after2 += error * error / kRuns;
  }
  std::cout << "lateness " << 1e3 * std::sqrt(before2) << " ms rms, found within " << 1e3 * std::sqrt(after2)
            << " ms rms; mean normalised squared error " << nees << "\n";
  EXPECT_LT(std::sqrt(after2), 0.2 * std::sqrt(before2));
  // Chi-square with 300 degrees of freedom over 300: 99.9 % of its values are in this interval.
  EXPECT_GT(nees, 0.753);
  EXPECT_LT(nees, 1.290);
}

}  // namespace
}  // namespace fovea::estimate
