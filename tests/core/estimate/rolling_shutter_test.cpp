// SPDX-License-Identifier: Apache-2.0
// Rolling shutter: outlines whose points are each seen at their own time, moved back to the stamp.
#include "firmware/core/estimate/rolling_shutter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>

#include "firmware/core/estimate/predict.hpp"
#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "tests/core/estimate/corner_views.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::estimate {
namespace {

constexpr double kRadius = 0.04;

// 30 us from row to row, the stamp at row 239.5 of 480.
config::PredictConfig Rolling() {
  config::PredictConfig config;
  config.row_time = 30e-6 * kFocalPx;
  config.row_y = 0.01;
  return config;
}

// The exact time of a point that moves by `y_at`, by iteration.
double TimeOf(const config::PredictConfig& config, const std::function<double(double)>& y_at) {
  double t = 0.0;
  for (int i = 0; i < 50; ++i) {
    t = config.row_time * (y_at(t) - config.row_y);
  }
  return t;
}

// Signed distance of an image point from the outline of a ball at `p`, to first order, by differences.
double OutsideOutline(const Eigen::Vector2d& xy, const Vec3& p) {
  const auto F = [&](double x, double y) {
    const Vec3 d(x, y, 1.0);
    return d.cross(p).norm() / d.norm() - kRadius;  // of the ray from the centre, less the radius
  };
  constexpr double kStep = 1e-6;
  const Eigen::Vector2d slope(F(xy.x() + kStep, xy.y()) - F(xy.x() - kStep, xy.y()),
                              F(xy.x(), xy.y() + kStep) - F(xy.x(), xy.y() - kStep));
  return F(xy.x(), xy.y()) / (slope.norm() / (2.0 * kStep));
}

// The outline of a ball at p + v t, each point at the time of its row: along a ray of the image from the
// ball's middle, the point that is on the outline at its own time.
std::vector<Eigen::Vector2d> RollingOutline(const config::PredictConfig& config, const Vec3& p,
                                            const Vec3& v) {
  constexpr int kPoints = 64;
  const double t = TimeOf(config, [&](double s) { return (p.y() + v.y() * s) / (p.z() + v.z() * s); });
  const Vec3 middle = p + v * t;
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < kPoints; ++k) {
    const double angle = 2.0 * M_PI * k / kPoints;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    const auto at = [&](double rho) { return Eigen::Vector2d(middle.head<2>() / middle.z() + rho * along); };
    double low = 0.0;
    double high = 0.5;
    for (int i = 0; i < 60; ++i) {
      const double half = 0.5 * (low + high);
      const Eigen::Vector2d xy = at(half);
      const Vec3 there = p + v * (config.row_time * (xy.y() - config.row_y));
      (OutsideOutline(xy, there) < 0.0 ? low : high) = half;
    }
    outline.push_back(at(low));
  }
  return outline;
}

// The ball whose outline is nearest to the points: Gauss-Newton, with differences.
Vec3 FitBall(const std::vector<Eigen::Vector2d>& outline, Vec3 p) {
  for (int round = 0; round < 10; ++round) {
    Mat3 A = Mat3::Zero();
    Vec3 b = Vec3::Zero();
    for (const Eigen::Vector2d& xy : outline) {
      Vec3 slope;
      for (int i = 0; i < 3; ++i) {
        const Vec3 step = 1e-6 * Vec3::Unit(i);
        slope[i] = (OutsideOutline(xy, p + step) - OutsideOutline(xy, p - step)) / 2e-6;
      }
      A += slope * slope.transpose();
      b -= slope * OutsideOutline(xy, p);
    }
    p += A.inverse() * b;
  }
  return p;
}

TEST(RollingShutterTest, BallIsMovedBackToItsPlaceAtTheStamp) {
  const config::PredictConfig config = Rolling();
  double before_px = 0.0;
  double after_px = 0.0;
  double before_depth = 0.0;
  double after_depth = 0.0;
  for (const Vec3& v :
       {Vec3(0.3, 0.0, 0.0), Vec3(0.0, 0.3, 0.0), Vec3(0.0, 0.0, 0.3), Vec3(-0.2, -0.2, 0.1)}) {
    for (const Vec3& p : {Vec3(0.0, 0.0, 0.35), Vec3(0.08, 0.06, 0.35), Vec3(-0.1, -0.07, 0.5)}) {
      const Vec3 seen = FitBall(RollingOutline(config, p, v), p);
      const Vec3 corrected = seen - SphereShiftByVelocity(config, kRadius, seen) * v;
      const auto off_px = [&](const Vec3& q) {
        return kFocalPx * (q.head<2>() / q.z() - p.head<2>() / p.z()).norm();
      };
      before_px = std::max(before_px, off_px(seen));
      after_px = std::max(after_px, off_px(corrected));
      before_depth = std::max(before_depth, std::fabs(seen.z() / p.z() - 1.0));
      after_depth = std::max(after_depth, std::fabs(corrected.z() / p.z() - 1.0));
    }
  }
  std::cout << "centre off by up to " << before_px << " px, corrected " << after_px << " px; depth by "
            << 100 * before_depth << " %, corrected " << 100 * after_depth << " %\n";
  EXPECT_GT(before_px, 1.0) << "the shutter is too quick for this test";
  EXPECT_GT(before_depth, 0.004);
  EXPECT_LT(after_px, 0.01);
  EXPECT_LT(after_depth, 0.0003);
}

// The shift is linear in the velocity, as the filter models it: by differences of the fitted centre.
TEST(RollingShutterTest, BallsShiftByVelocityIsTheDerivativeOfTheFittedCentre) {
  const config::PredictConfig config = Rolling();
  constexpr double kStep = 0.01;  // [m/s]
  double worst = 0.0;
  double largest = 0.0;
  for (const Vec3& p : {Vec3(0.0, 0.0, 0.35), Vec3(0.08, 0.06, 0.35), Vec3(-0.1, -0.07, 0.5)}) {
    const Mat3 by_v = SphereShiftByVelocity(config, kRadius, p);
    for (int i = 0; i < 3; ++i) {
      const Vec3 v = kStep * Vec3::Unit(i);
      const Vec3 seen =
          (FitBall(RollingOutline(config, p, v), p) - FitBall(RollingOutline(config, p, -v), p)) /
          (2.0 * kStep);
      worst = std::max(worst, (seen - by_v.col(i)).norm());
      largest = std::max(largest, seen.norm());
    }
  }
  std::cout << "derivative up to " << 1e3 * largest << " ms, off by " << 1e3 * worst << " ms\n";
  EXPECT_GT(largest, 1e-3);
  // The points of this outline are even about the picture's middle, those of the model about the ball's axis.
  EXPECT_LT(worst, 0.025 * largest);
}

TEST(RollingShutterTest, CornersAreMovedBackToTheirPlacesAtTheStamp) {
  const config::PredictConfig config = Rolling();
  double before_px = 0.0;
  double after_px = 0.0;
  for (const Polygon& polygon :
       {features::MakeSquare(0.08), features::MakeTriangle(features::kDefaultTriangle)}) {
    for (const Vec3& v : {Vec3(0.3, 0.0, 0.0), Vec3(0.0, -0.3, 0.0), Vec3(-0.1, 0.2, 0.3)}) {
      const Pose X_CO{Turned(Vec3(0.3, -0.2, 0.5)), Vec3(0.03, 0.05, 0.35)};
      const Vec3 w(0.5, -0.3, 1.0);
      const auto corner_at = [&](int i, double t) {
        const Vec3 p =
            X_CO.p + t * v + Turned(w * t) * (X_CO.R * polygon.corners[static_cast<std::size_t>(i)]);
        return Eigen::Vector2d(p.head<2>() / p.z());
      };
      SeenCorners::Vector seen(2 * polygon.num_corners);
      SeenCorners::Vector truth(2 * polygon.num_corners);
      for (int i = 0; i < polygon.num_corners; ++i) {
        const double t = TimeOf(config, [&](double s) { return corner_at(i, s).y(); });
        seen.segment<2>(2 * i) = corner_at(i, t);
        truth.segment<2>(2 * i) = corner_at(i, 0.0);
      }
      before_px = std::max(before_px, kFocalPx * (seen - truth).cwiseAbs().maxCoeff());
      MoveCornersToStamp(config, {X_CO, v, w}, seen);
      after_px = std::max(after_px, kFocalPx * (seen - truth).cwiseAbs().maxCoeff());
    }
  }
  std::cout << "corners off by up to " << before_px << " px, corrected " << after_px << " px\n";
  EXPECT_GT(before_px, 1.0);
  EXPECT_LT(after_px, 0.02);
}

TEST(RollingShutterTest, DiscsCentreIsMovedBack) {
  const config::PredictConfig config = Rolling();
  const Vec3 p(0.05, -0.06, 0.4);
  const Vec3 v(0.2, -0.1, 0.1);
  const double t = TimeOf(config, [&](double s) { return (p.y() + v.y() * s) / (p.z() + v.z() * s); });
  const Vec3 seen = p + t * v;
  const Vec3 left = seen - DiscShiftByVelocity(config, seen) * v - p;
  EXPECT_GT((t * v).norm(), 1e-4);
  EXPECT_LT(left.norm(), 1e-12);
}

// The motion in the camera, by differences of poses.
TEST(RollingShutterTest, MotionSeenFromAMovingCameraIsThatOfItsPoses) {
  const Pose X_BC{Turned(Vec3(2.0, 0.3, -0.5)), Vec3(0.4, 0.1, 0.6)};
  const Pose X_BO{Turned(Vec3(0.2, 2.5, 0.4)), Vec3(0.5, 0.0, 0.1)};
  model::Vec6 V_BC_C;
  V_BC_C << 0.2, -0.1, 0.3, 0.5, -0.4, 0.7;
  const Vec3 v_BO_B(0.1, 0.15, -0.05);
  const Vec3 w_BO_B(-0.3, 0.6, 0.2);
  const auto X_CO_at = [&](double t) {
    const Pose camera{X_BC.R * Turned(V_BC_C.tail<3>() * t), X_BC.p + X_BC.R * V_BC_C.head<3>() * t};
    const Pose object{Turned(w_BO_B * t) * X_BO.R, X_BO.p + v_BO_B * t};
    return camera.Inverse() * object;
  };
  const MotionInCamera seen = SeenFrom(X_BC, V_BC_C, X_CO_at(0.0), v_BO_B, w_BO_B);
  constexpr double kStep = 1e-5;
  const Pose before = X_CO_at(-kStep);
  const Pose after = X_CO_at(kStep);
  const double off_v = (seen.v - (after.p - before.p) / (2.0 * kStep)).norm();
  const double off_w = (seen.w - Between(after.R, before.R) / (2.0 * kStep)).norm();
  std::cout << "off by " << off_v << " m/s, " << off_w << " rad/s\n";
  EXPECT_LT(off_v, 1e-7);
  EXPECT_LT(off_w, 1e-7);
}

// The estimate of a moving target from a moving camera, 40 ms old at 30 Hz: by pictures whose rows are
// exposed one after the other, with the correction and without, and by pictures at one instant.
TEST(RollingShutterTest, PredictionIsAsGoodAsWithAGlobalShutter) {
  config::ServoConfig config = test::PandaConfig();
  config.predict.stamp_sigma = 0.0;  // a wrong latency is not to explain what the shutter does
  config::ServoConfig corrected = config;
  corrected.predict.row_time = Rolling().row_time;
  const auto joints_at = [](double t) {
    model::VecN q = test::Ready();
    for (int i = 0; i < 7; ++i) {
      q[i] += 0.15 * std::sin(1.3 * t + i);
    }
    return q;
  };
  const auto camera_at = [&](double t) {
    model::ArmPoses poses;
    model::ComputePoses(config.arm, joints_at(t), poses);
    return poses.X_BE * config.X_EC;
  };
  const Vec3 middle_B = camera_at(0.0) * Vec3(0.0, 0.0, 0.45);
  const auto target_in_camera = [&](double t) {
    return Vec3(camera_at(t).Inverse() *
                Vec3(middle_B + 0.1 * Vec3(std::cos(2.0 * t), std::sin(2.0 * t), 0.0)));
  };
  const auto measure = [&](double t, double row_time) {
    config::PredictConfig shutter;
    shutter.row_time = row_time;
    constexpr double kStep = 1e-4;
    const Vec3 v = (target_in_camera(t + kStep) - target_in_camera(t - kStep)) / (2.0 * kStep);
    const Vec3 p = target_in_camera(t);
    const Vec3 s = FitBall(RollingOutline(shutter, p, v), p) / kRadius;
    hal::FeatureMeasurement m;
    m.stamp_ns = std::llround(t * 1e9);
    m.found = true;
    m.dim = 3;
    for (int i = 0; i < 3; ++i) {
      m.s[static_cast<std::size_t>(i)] = s[i];
      m.cov_s[static_cast<std::size_t>(i * hal::kMaxFeatureDim + i)] = 1e-5;
    }
    return m;
  };
  struct Servo {
    const char* name;
    const config::ServoConfig* config;
    double row_time;  // of the camera
    PredictState state;
    EyeWatch eye;
    double worst_mm = 0.0;
    int rejected = 0;
  };
  const double row_time = corrected.predict.row_time;
  std::array<Servo, 3> servos{{{"global", &config, 0.0, {}, {}},
                               {"corrected", &corrected, row_time, {}, {}},
                               {"not corrected", &config, row_time, {}, {}}}};
  for (int ms = 0; ms < 3000; ++ms) {
    const double t = 1e-3 * ms;
    for (Servo& servo : servos) {
      servo.state.history.Push(ms * hal::kNsPerMs, joints_at(t));
      if (ms >= 40 && (ms - 40) % 33 == 0) {
        const hal::Intake intake = TakeMeasurement(*servo.config, ms * hal::kNsPerMs,
                                                   measure(t - 0.04, servo.row_time), servo.state, servo.eye);
        servo.rejected += intake == hal::Intake::kTaken ? 0 : 1;
      }
      const Prediction p = Predict(*servo.config, ms * hal::kNsPerMs, camera_at(t), servo.state);
      if (ms > 1500) {
        servo.worst_mm = std::max(servo.worst_mm, 1e3 * (p.seen.X_CO.p - target_in_camera(t)).norm());
      }
    }
  }
  for (const Servo& servo : servos) {
    std::cout << servo.name << ": worst error of the prediction " << servo.worst_mm << " mm, "
              << servo.rejected << " measurements rejected\n";
  }
  EXPECT_EQ(servos[0].rejected, 0);
  EXPECT_EQ(servos[1].rejected, 0);
  EXPECT_LT(servos[1].worst_mm, servos[0].worst_mm + 0.1);
  EXPECT_GT(servos[2].worst_mm, servos[0].worst_mm + 1.0);
}

}  // namespace
}  // namespace fovea::estimate
