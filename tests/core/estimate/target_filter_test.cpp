// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/target_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "fovea/hal/types.hpp"
#include "tests/support/panda.hpp"

namespace fovea::estimate {
namespace {

using hal::Intake;
using model::Mat3;
using model::Vec3;

constexpr std::int64_t kFrameNs = 33'333'333;

std::int64_t StampOf(int frame) { return frame * kFrameNs; }
double TimeOf(int frame) { return static_cast<double>(StampOf(frame)) * 1e-9; }

TEST(TargetFilterTest, FollowsAConstantAccelerationExactly) {
  config::PredictConfig config;
  TargetFilter filter;
  const Vec3 p0(0.5, 0.1, 0.04), v0(0.1, -0.2, 0.0), a0(0.3, 0.1, -0.2);
  const auto truth = [&](double t) { return Vec3(p0 + t * v0 + 0.5 * t * t * a0); };
  const Mat3 cov = Mat3::Identity() * 1e-10;
  for (int k = 0; k < 60; ++k) {
    EXPECT_EQ(Update(config, {StampOf(k), truth(TimeOf(k)), cov}, filter), Intake::kTaken);
  }
  const std::int64_t now = StampOf(59) + 70 * hal::kNsPerMs;
  const double t = static_cast<double>(now) * 1e-9;
  const TargetMotion motion = MotionAt(config, filter, now);
  std::cout << "70 ms ahead: position off by " << (motion.p_BO - truth(t)).norm() << " m, velocity by "
            << (motion.v_BO - (v0 + t * a0)).norm() << " m/s\n";
  EXPECT_LT((motion.p_BO - truth(t)).norm(), 1e-5);
  EXPECT_LT((motion.v_BO - (v0 + t * a0)).norm(), 1e-4);
}

TEST(TargetFilterTest, CovarianceIsConsistentForATargetOfItsModel) {
  // Normalised squared error of [p; v; a] over many runs: 9 on average if the covariance is right.
  config::PredictConfig config;
  config.target_speed_max = config.target_acceleration_max = 1e3;  // its own model has no bounds
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  const double sigma = 2e-4;
  const double q = config.target_jerk * config.target_jerk * 0.1;
  double sum = 0.0;
  int count = 0;
  for (int run = 0; run < 300; ++run) {
    TargetFilter filter;
    Vec3 p(0.5, 0.0, 0.1);
    Vec3 v = 0.3 * Vec3(normal(engine), normal(engine), normal(engine));
    Vec3 a = 0.5 * Vec3(normal(engine), normal(engine), normal(engine));
    for (int k = 0; k < 40; ++k) {
      const Vec3 noise(normal(engine), normal(engine), normal(engine));
      (void)Update(config, {StampOf(k), p + sigma * noise, Mat3::Identity() * sigma * sigma}, filter);
      if (k == 39) {
        break;
      }
      // The target itself: white jerk in steps of 1 ms.
      for (int ms = 0; ms < 33; ++ms) {
        const double dt = static_cast<double>(kFrameNs) * 1e-9 / 33;
        a += std::sqrt(q * dt) * Vec3(normal(engine), normal(engine), normal(engine));
        v += dt * a;
        p += dt * v;
      }
    }
    ASSERT_EQ(filter.stamp_ns, StampOf(39));
    Eigen::Matrix<double, 9, 1> e;
    e << filter.x[0] - p, filter.x[1] - v, filter.x[2] - a;
    Eigen::Matrix<double, 9, 9> P;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        P.block<3, 3>(3 * static_cast<int>(i), 3 * static_cast<int>(j)) = filter.P[i][j];
      }
    }
    EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
    sum += e.dot(P.inverse() * e);
    ++count;
  }
  const double nees = sum / count;
  std::cout << "mean normalised squared error " << nees << ", expected 9\n";
  EXPECT_NEAR(nees, 9.0, 1.0);  // 300 runs: standard deviation 0.24
}

// Rolling shutter: a measured place is off by a matrix times the target's velocity. The filter does not know
// the velocity of a target that it has just seen, and its covariance says so.
TEST(TargetFilterTest, CovarianceIsConsistentUnderARollingShutter) {
  config::PredictConfig config;
  config.target_speed_max = config.target_acceleration_max = 1e3;
  std::mt19937_64 engine(13);
  std::normal_distribution<double> normal;
  constexpr double kSigma = 2e-4;
  constexpr double kRowsS = 0.005;  // a target half a picture's height from the stamp's row
  constexpr int kRuns = 300;
  const double q = config.target_jerk * config.target_jerk * 0.1;
  for (const int frames : {1, 2, 3, 20}) {
    double nees = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      TargetFilter filter;
      Vec3 p(0.5, 0.0, 0.1);
      Vec3 v = 0.3 * Vec3(normal(engine), normal(engine), normal(engine));
      Vec3 a = 0.5 * Vec3(normal(engine), normal(engine), normal(engine));
      for (int k = 0; k < frames; ++k) {
        Mat3 shift_by_v;
        for (Eigen::Index i = 0; i < 9; ++i) {
          shift_by_v(i) = kRowsS * normal(engine);
        }
        const Vec3 noise(normal(engine), normal(engine), normal(engine));
        MeasuredCentre measured{StampOf(k), p + shift_by_v * v + kSigma * noise,
                                Mat3::Identity() * kSigma * kSigma};
        measured.shift_by_v_B = shift_by_v;
        EXPECT_EQ(Update(config, measured, filter), Intake::kTaken);
        for (int ms = 0; ms < 33 && k + 1 < frames; ++ms) {
          const double dt = static_cast<double>(kFrameNs) * 1e-9 / 33;
          a += std::sqrt(q * dt) * Vec3(normal(engine), normal(engine), normal(engine));
          v += dt * a;
          p += dt * v;
        }
      }
      Eigen::Matrix<double, 9, 1> e;
      e << filter.x[0] - p, filter.x[1] - v, filter.x[2] - a;
      Eigen::Matrix<double, 9, 9> P;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          P.block<3, 3>(3 * static_cast<int>(i), 3 * static_cast<int>(j)) = filter.P[i][j];
        }
      }
      EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
      nees += e.dot(P.inverse() * e) / kRuns;
    }
    std::cout << frames << " frames: mean normalised squared error " << nees << ", expected 9\n";
    EXPECT_NEAR(nees, 9.0, 0.82);  // 99.9 % of chi-square with 2700 degrees of freedom, over 300
  }
}

// The camera swings to and fro, and its stamps have a common error, which drifts by a millisecond (1 sigma)
// in a second. The filter finds the error, whatever the target does, and its variance is right.
TEST(TargetFilterTest, MovingCameraShowsTheStampsCommonError) {
  config::PredictConfig config;
  config.target_speed_max = config.target_acceleration_max = 1e3;
  config.target_jerk = 0.02;  // of a target that may jerk more, one cannot tell its motion from wrong stamps
  std::mt19937_64 engine(12);
  std::normal_distribution<double> normal;
  const double sigma = 2e-4;
  const double q = config.target_jerk * config.target_jerk * 0.1;
  constexpr int kRuns = 300;
  double nees = 0.0;
  double before2 = 0.0;
  double after2 = 0.0;
  double sigma_sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    double late = config.stamp_sigma * normal(engine);
    TargetFilter filter;
    Vec3 p(0.5, 0.0, 0.1);
    Vec3 v = 0.3 * Vec3(normal(engine), normal(engine), normal(engine));
    Vec3 a = 0.5 * Vec3(normal(engine), normal(engine), normal(engine));
    for (int k = 0; k < 60; ++k) {
      const Vec3 v_held(0.3 * std::sin(3.0 * TimeOf(k)), 0.2 * std::cos(4.0 * TimeOf(k)), 0.0);
      const Vec3 noise(normal(engine), normal(engine), normal(engine));
      MeasuredCentre measured{StampOf(k), p + late * v_held + sigma * noise,
                              Mat3::Identity() * sigma * sigma};
      measured.late = filter.late;
      measured.late_sigma = config.stamp_sigma;
      measured.p_BO -= filter.late * v_held;  // the servo uses the camera's pose of the time that it believes
      measured.v_BO_held = v_held;
      EXPECT_EQ(Update(config, measured, filter), Intake::kTaken);
      if (k == 59) {
        break;
      }
      for (int ms = 0; ms < 33; ++ms) {
        const double dt = static_cast<double>(kFrameNs) * 1e-9 / 33;
        a += std::sqrt(q * dt) * Vec3(normal(engine), normal(engine), normal(engine));
        v += dt * a;
        p += dt * v;
      }
      late += std::sqrt(1e-6 * 1e-9 * static_cast<double>(kFrameNs)) * normal(engine);
    }
    const double error = filter.late - late;
    nees += error * error / filter.P_late / kRuns;
    before2 += late * late / kRuns;
    after2 += error * error / kRuns;
    sigma_sum += std::sqrt(filter.P_late) / kRuns;
  }
  std::cout << "common error of stamps " << 1e3 * std::sqrt(before2) << " ms rms, found within "
            << 1e3 * std::sqrt(after2) << " ms rms, stated " << 1e3 * sigma_sum
            << " ms; mean normalised squared error " << nees << "\n";
  EXPECT_LT(std::sqrt(after2), 0.2 * std::sqrt(before2));
  // Chi-square with 300 degrees of freedom over 300: 99.9 % of its values are in this interval.
  EXPECT_GT(nees, 0.753);
  EXPECT_LT(nees, 1.290);
}

// From a camera at rest, a late picture of a moving target is the same as one of a target that is further
// back.
TEST(TargetFilterTest, RestingCameraCannotTellTheStampsCommonError) {
  const config::PredictConfig config;
  TargetFilter filter;
  for (int k = 0; k < 300; ++k) {
    const double t = TimeOf(k);
    const Vec3 p(0.5 + 0.1 * std::sin(2.0 * t), 0.1 * std::cos(2.0 * t), 0.04);
    MeasuredCentre measured{StampOf(k), p, Mat3::Identity() * 1e-8};
    measured.late_sigma = config.stamp_sigma;
    EXPECT_EQ(Update(config, measured, filter), Intake::kTaken);
  }
  EXPECT_EQ(filter.late, 0.0);
  EXPECT_DOUBLE_EQ(std::sqrt(filter.P_late), config.stamp_sigma)
      << "nothing is learnt, and nothing forgotten";
}

TEST(TargetFilterTest, RightStampsStayRight) {
  config::PredictConfig config;
  config.stamp_sigma = 0.0;
  TargetFilter filter;
  for (int k = 0; k < 300; ++k) {
    MeasuredCentre measured{StampOf(k), Vec3(0.5, 0.0, 0.1), Mat3::Identity() * 1e-8};
    measured.v_BO_held = Vec3(std::sin(TimeOf(k)), 0.0, 0.0);
    EXPECT_EQ(Update(config, measured, filter), Intake::kTaken);
  }
  EXPECT_EQ(filter.late, 0.0);
  EXPECT_EQ(filter.P_late, 0.0);
}

// A learnt offset is not corrected twice: a filter that has found the error itself stays as it is, to the
// last bit, while the offset comes in.
TEST(TargetFilterTest, LearntOffsetLeavesAFilterThatRunsAsItIs) {
  config::PredictConfig config;
  config.target_jerk = 0.02;
  config::PredictConfig learns = config;
  const double late = 0.02;
  TargetFilter filter;
  TargetFilter same;
  for (int k = 0; k < 200; ++k) {
    learns.stamp_offset = late * std::clamp((k - 90) / 8.0, 0.0, 1.0);
    const Vec3 v_held(0.3 * std::sin(3.0 * TimeOf(k)), 0.2 * std::cos(4.0 * TimeOf(k)), 0.0);
    const auto measure = [&](const TargetFilter& of) {
      MeasuredCentre measured{StampOf(k), Vec3(0.5, 0.0, 0.1) + (late - of.late) * v_held,
                              Mat3::Identity() * 1e-8};
      measured.late = of.late;
      measured.v_BO_held = v_held;
      return measured;
    };
    EXPECT_EQ(Update(config, measure(filter), filter), Intake::kTaken);
    EXPECT_EQ(Update(learns, measure(same), same), Intake::kTaken);
    ASSERT_EQ(same.late, filter.late) << k;
    ASSERT_EQ(same.x[0], filter.x[0]) << k;
  }
  std::cout << "found " << 1e3 * same.late << " ms of " << 1e3 * late << " ms\n";
  EXPECT_NEAR(same.late, late, 1e-3);
}

// An error beyond the credible range is found once the offset has moved the range.
TEST(TargetFilterTest, LearntOffsetMovesTheCredibleRange) {
  config::PredictConfig config;
  config.target_jerk = 0.02;
  const double late = 0.045;
  TargetFilter filter;
  for (int k = 0; k < 300; ++k) {
    config.stamp_offset = 0.03 * std::clamp((k - 150) / 8.0, 0.0, 1.0);
    const Vec3 v_held(0.3 * std::sin(3.0 * TimeOf(k)), 0.2 * std::cos(4.0 * TimeOf(k)), 0.0);
    MeasuredCentre measured{StampOf(k), Vec3(0.5, 0.0, 0.1) + (late - filter.late) * v_held,
                            Mat3::Identity() * 1e-8};
    measured.late = filter.late;
    measured.late_sigma = config.stamp_sigma;
    measured.v_BO_held = v_held;
    static_cast<void>(Update(config, measured, filter));
    if (k == 150) {
      EXPECT_NEAR(filter.late, 0.03, 1e-12) << "three standard deviations";
    }
  }
  std::cout << "found " << 1e3 * filter.late << " ms of " << 1e3 * late << " ms\n";
  EXPECT_NEAR(filter.late, late, 1e-3);
}

TEST(TargetFilterTest, RejectsOutliersAndRestartsWhenTheTargetMoved) {
  config::PredictConfig config;
  config.gate_rejects_max = 3;
  TargetFilter filter;
  const Vec3 p(0.5, 0.1, 0.04);
  const Mat3 cov = Mat3::Identity() * 1e-8;
  int k = 0;
  for (; k < 30; ++k) {
    (void)Update(config, {StampOf(k), p, cov}, filter);
  }
  const Vec3 far = p + Vec3(0.2, 0.0, 0.0);
  EXPECT_EQ(Update(config, {StampOf(k++), far, cov}, filter), Intake::kOutlier);
  EXPECT_LT((filter.x[0] - p).norm(), 1e-6) << "one outlier is ignored";
  EXPECT_EQ(Update(config, {StampOf(k++), p, cov}, filter), Intake::kTaken);
  EXPECT_EQ(filter.rejected_in_row, 0);
  EXPECT_EQ(Update(config, {StampOf(k++), far, cov}, filter), Intake::kOutlier);
  EXPECT_EQ(Update(config, {StampOf(k++), far, cov}, filter), Intake::kOutlier);
  EXPECT_EQ(Update(config, {StampOf(k++), far, cov}, filter), Intake::kTaken)
      << "three in a row: the target has moved";
  EXPECT_LT((filter.x[0] - far).norm(), 1e-12);
  EXPECT_EQ(filter.accepted, 1);
}

// An error that calibration may explain is no outlier: the measurement moves the estimate like any other.
// Here the hand has just turned by 0.3 rad, with a mount that is known to 0.02 rad.
TEST(TargetFilterTest, CalibrationDoubtWidensOnlyTheGate) {
  config::ServoConfig servo = test::PandaConfig();
  const config::PredictConfig& config = servo.predict;
  const Vec3 p(0.5, 0.1, 0.04);
  const Vec3 p_CO_C(0.0, 0.0, 0.4);
  const Mat3 cov = Mat3::Identity() * 1e-8;
  TargetFilter filter;
  for (int k = 0; k < 30; ++k) {
    (void)Update(config, {StampOf(k), p, cov}, filter);
  }
  model::VecN q = test::Ready();
  JointHistory history;
  history.Push(0, q);
  history.Push(StampOf(30) - 20 * hal::kNsPerMs, q);
  q[6] += 0.3;
  history.Push(StampOf(30), q);
  model::ArmPoses poses;
  model::ComputePoses(servo.arm, q, poses);
  const model::Pose X_BC = poses.X_BE * servo.X_EC;
  const auto doubted = [&](int frame, const Vec3& at, MeasurementDoubt& doubt) {
    MeasuredCentre measured{StampOf(frame), at, cov};
    measured.doubt = &doubt;
    measured.p_CO_C = p_CO_C;
    return Update(config, measured, filter);
  };
  TargetFilter plain = filter;
  const Vec3 off = p + Vec3(0.004, 0.0, 0.0);
  EXPECT_EQ(Update(config, {StampOf(30), off, cov}, plain), Intake::kOutlier);
  MeasurementDoubt at_30(servo, history, StampOf(30), X_BC, p_CO_C);
  EXPECT_EQ(doubted(30, off, at_30), Intake::kTaken);
  MeasurementDoubt at_31(servo, history, StampOf(31), X_BC, p_CO_C);
  EXPECT_EQ(doubted(31, p + Vec3(0.1, 0.0, 0.0), at_31), Intake::kOutlier);
}

// Whatever an adversary measures, the estimated speed and acceleration of the target stay bounded.
TEST(TargetFilterTest, SpeedAndAccelerationStayWithinTheirBounds) {
  config::PredictConfig config;
  config.target_speed_max = 0.5;
  config.target_acceleration_max = 2.0;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  TargetFilter filter;
  double fastest = 0.0;
  double furthest = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const Vec3 p = Vec3(normal(engine), normal(engine), normal(engine)) * std::pow(10.0, normal(engine));
    (void)Update(config, {StampOf(k), p, Mat3::Identity() * std::pow(10.0, -6.0 + normal(engine))}, filter);
    const std::int64_t later = filter.stamp_ns + 600 * hal::kNsPerMs;
    fastest = std::max(fastest, MotionAt(config, filter, later).v_BO.norm());
    furthest = std::max(furthest, (MotionAt(config, filter, later).p_BO - filter.x[0]).norm());
    ASSERT_LE(filter.x[2].norm(), config.target_acceleration_max * (1.0 + 1e-12));
  }
  std::cout << "at most " << fastest << " m/s, " << furthest << " m in 0.6 s\n";
  EXPECT_LE(fastest, 0.5 * (1.0 + 1e-12));
  EXPECT_LE(furthest, 0.3 * (1.0 + 1e-12));
  EXPECT_GT(fastest, 0.49) << "the adversary must reach the bound";
}

TEST(TargetFilterTest, IgnoresMeasurementsThatAreNotNewer) {
  config::PredictConfig config;
  TargetFilter filter;
  const Mat3 cov = Mat3::Identity() * 1e-8;
  (void)Update(config, {StampOf(3), {0.5, 0, 0}, cov}, filter);
  EXPECT_EQ(Update(config, {StampOf(3), {0.6, 0, 0}, cov}, filter), Intake::kTooOld);
  EXPECT_EQ(Update(config, {StampOf(2), {0.6, 0, 0}, cov}, filter), Intake::kTooOld);
  // Not even if it equals the estimate, so that the gate would accept it.
  EXPECT_EQ(Update(config, {StampOf(3), {0.5, 0, 0}, cov}, filter), Intake::kTooOld);
  EXPECT_EQ(Update(config, {StampOf(2), {0.5, 0, 0}, cov}, filter), Intake::kTooOld);
  EXPECT_EQ(filter.x[0].x(), 0.5);
  EXPECT_EQ(filter.stamp_ns, StampOf(3));
  EXPECT_EQ(filter.accepted, 1);
}

}  // namespace
}  // namespace fovea::estimate
