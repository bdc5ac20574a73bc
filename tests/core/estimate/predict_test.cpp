// SPDX-License-Identifier: Apache-2.0
// Predicts where the target is now from measurements that are old on arrival.
#include "firmware/core/estimate/predict.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <utility>

#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::estimate {
namespace {

TEST(JointHistoryTest, InterpolatesBetweenTicksAndForgetsTheOldest) {
  JointHistory history;
  model::VecN q(7);
  EXPECT_FALSE(history.At(0, q));
  for (int i = 0; i < 2 * JointHistory::kCapacity + 17; ++i) {
    history.Push(i * hal::kNsPerMs, model::VecN::Constant(7, i));
  }
  const int newest = 2 * JointHistory::kCapacity + 16;
  const int oldest = newest - JointHistory::kCapacity + 1;
  ASSERT_TRUE(history.At((newest - 3) * hal::kNsPerMs + 250'000, q));
  EXPECT_NEAR(q[0], newest - 3 + 0.25, 1e-9);
  ASSERT_TRUE(history.At((newest + 5) * hal::kNsPerMs, q));
  EXPECT_EQ(q[6], newest);
  ASSERT_TRUE(history.At(oldest * hal::kNsPerMs, q));
  EXPECT_EQ(q[0], oldest);
  EXPECT_FALSE(history.At(oldest * hal::kNsPerMs - 1, q));
}

class PredictTest : public testing::Test {
 protected:
  // The joints move all the time; the camera with them.
  model::VecN JointsAt(double t) {
    model::VecN q = test::Ready();
    for (int i = 0; i < 7; ++i) {
      q[i] += 0.15 * std::sin(1.3 * t + i);
    }
    return q;
  }
  model::Pose CameraAt(double t) {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, JointsAt(t), poses);
    return poses.X_BE * config_.X_EC;
  }
  hal::FeatureMeasurement Measure(double t, const model::Vec3& p_BO) {
    hal::FeatureMeasurement m;
    m.stamp_ns = std::llround(t * 1e9);
    m.found = true;
    m.dim = 3;
    const model::Vec3 s = (CameraAt(t).Inverse() * p_BO) / config_.feature.radius;
    for (int i = 0; i < 3; ++i) {
      m.s[static_cast<std::size_t>(i)] = s[i];
      m.cov_s[static_cast<std::size_t>(i * hal::kMaxFeatureDim + i)] = 1e-8;
    }
    return m;
  }

  config::ServoConfig config_ = test::PandaConfig();
  EyeWatch eye_;
};

// A target on a circle, a moving camera, measurements 40 ms old at 30 Hz: the prediction is where the target
// is now. The newest measurement, held, is not.
TEST_F(PredictTest, CompensatesLatencyWhileCameraAndTargetMove) {
  const auto target = [](double t) {
    return model::Vec3(0.55 + 0.1 * std::cos(2.0 * t), 0.1 * std::sin(2.0 * t), 0.05);
  };
  PredictState state;
  PredictState state_held;
  config::ServoConfig held = config_;
  held.predict.enabled = false;
  double worst = 0.0;
  double worst_held = 0.0;
  constexpr int kLatencyMs = 40;
  for (int ms = 0; ms < 4000; ++ms) {
    const double t = 1e-3 * ms;
    const std::int64_t now = ms * hal::kNsPerMs;
    state.history.Push(now, JointsAt(t));
    state_held.history.Push(now, JointsAt(t));
    const bool arrives = ms >= kLatencyMs && (ms - kLatencyMs) % 33 == 0;
    const hal::FeatureMeasurement m = Measure(t - 1e-3 * kLatencyMs, target(t - 1e-3 * kLatencyMs));
    if (arrives) {
      ASSERT_EQ(TakeMeasurement(config_, now, m, state, eye_), hal::Intake::kTaken);
      ASSERT_EQ(TakeMeasurement(held, now, m, state_held, eye_), hal::Intake::kTaken);
    }
    const Prediction p = Predict(config_, now, CameraAt(t), state);
    const Prediction h = Predict(held, now, CameraAt(t), state_held);
    if (ms > 2000) {
      ASSERT_TRUE(p.known);
      const model::Vec3 truth = CameraAt(t).Inverse() * target(t);
      worst = std::max(worst, (p.seen.X_CO.p - truth).norm());
      worst_held = std::max(worst_held, (h.seen.X_CO.p - truth).norm());
      EXPECT_GE(p.age_ns, kLatencyMs * hal::kNsPerMs);
      EXPECT_LE(p.age_ns, (kLatencyMs + 33) * hal::kNsPerMs);
      EXPECT_TRUE(h.seen.v_BO_C.isZero());
    }
  }
  std::cout << "worst error " << 1e3 * worst << " mm predicted, " << 1e3 * worst_held << " mm held\n";
  EXPECT_LT(worst, 0.5e-3);
  EXPECT_GT(worst_held, 10e-3);
}

// The pictures are 20 ms older or newer than their stamps say. While the camera moves, the filter of a target
// that moves smoothly finds that, and predicts the target where it is; without it, the target is off by
// millimetres.
TEST_F(PredictTest, FindsThatTheLatencyIsWrong) {
  const auto target = [](double t) {
    return model::Vec3(0.55 + 0.1 * std::cos(0.5 * t), 0.1 * std::sin(0.5 * t), 0.05);
  };
  constexpr int kBelievedMs = 40;
  config_.predict.target_jerk = 0.02;
  config::ServoConfig trusting = config_;
  trusting.predict.stamp_sigma = 0.0;
  for (const int late_ms : {-20, 0, 20}) {
    PredictState state;
    PredictState state_trusting;
    double worst = 0.0;
    double worst_trusting = 0.0;
    Prediction p;
    for (int ms = 0; ms < 12'000; ++ms) {
      const double t = 1e-3 * ms;
      const std::int64_t now = ms * hal::kNsPerMs;
      state.history.Push(now, JointsAt(t));
      state_trusting.history.Push(now, JointsAt(t));
      if (ms >= 100 && ms % 33 == 0) {
        const double taken = t - 1e-3 * (kBelievedMs + late_ms);
        hal::FeatureMeasurement m = Measure(taken, target(taken));
        m.stamp_ns = now - kBelievedMs * hal::kNsPerMs;
        (void)TakeMeasurement(config_, now, m, state, eye_);
        (void)TakeMeasurement(trusting, now, m, state_trusting, eye_);
      }
      p = Predict(config_, now, CameraAt(t), state);
      if (ms > 8000) {
        worst = std::max(worst, (p.p_BO - target(t)).norm());
        worst_trusting = std::max(
            worst_trusting, (Predict(trusting, now, CameraAt(t), state_trusting).p_BO - target(t)).norm());
      }
    }
    std::cout << "pictures " << late_ms << " ms older than their stamps: found " << 1e3 * p.late.mean_s
              << " +- " << 1e3 * p.late.sigma_s << " ms; worst error " << 1e3 * worst
              << " mm, without finding it " << 1e3 * worst_trusting << " mm\n";
    EXPECT_NEAR(p.late.mean_s, 1e-3 * late_ms, 2.0 * p.late.sigma_s);
    EXPECT_LT(p.late.sigma_s, 0.004);
    EXPECT_LT(worst, late_ms == 0 ? 1e-3 : 0.5 * worst_trusting);
  }
}

// The lateness belongs to the camera: it outlives the target that has shown it, and grows less certain with
// time.
TEST_F(PredictTest, LatenessOutlivesTheTarget) {
  const model::Vec3 first(0.55, 0.0, 0.05);
  const model::Vec3 second(0.5, 0.05, 0.05);
  constexpr int kLateMs = 20;
  constexpr int kBelievedMs = 40;
  constexpr int kLostMs = 12'000;
  config_.predict.target_jerk = 0.02;
  PredictState state;
  StampError learnt;
  for (int ms = 0; ms <= kLostMs + 1000; ++ms) {
    // The camera stands still from the loss on, so that the second target shows nothing of the lateness.
    const double t = 1e-3 * std::min(ms, kLostMs);
    const std::int64_t now = ms * hal::kNsPerMs;
    state.history.Push(now, JointsAt(t));
    if (ms >= 100 && ms < kLostMs && ms % 33 == 0) {
      const double taken = t - 1e-3 * (kBelievedMs + kLateMs);
      hal::FeatureMeasurement m = Measure(taken, first);
      m.stamp_ns = now - kBelievedMs * hal::kNsPerMs;
      (void)TakeMeasurement(config_, now, m, state, eye_);
    }
    if (ms == kLostMs) {
      learnt = Predict(config_, now, CameraAt(t), state).late;
      state.Reset();
    }
    if (ms >= kLostMs + 100 && ms % 33 == 0) {
      hal::FeatureMeasurement m = Measure(t, second);
      m.stamp_ns = now - kBelievedMs * hal::kNsPerMs;
      ASSERT_EQ(TakeMeasurement(config_, now, m, state, eye_), hal::Intake::kTaken);
    }
  }
  const StampError then = Predict(config_, (kLostMs + 1000) * hal::kNsPerMs, CameraAt(12.0), state).late;
  std::cout << "lateness " << 1e3 * learnt.mean_s << " +- " << 1e3 * learnt.sigma_s
            << " ms, of the next target " << 1e3 * then.mean_s << " +- " << 1e3 * then.sigma_s << " ms\n";
  EXPECT_NEAR(learnt.mean_s, 1e-3 * kLateMs, 2.0 * learnt.sigma_s);
  EXPECT_NEAR(then.mean_s, learnt.mean_s, 1e-4);
  EXPECT_GT(then.sigma_s, learnt.sigma_s);
  EXPECT_LT(then.sigma_s, 2.0 * learnt.sigma_s + 1e-3);
}

TEST_F(PredictTest, RejectsUnusableMeasurementsWithTheirReason) {
  PredictState state;
  for (int ms = 0; ms < 100; ++ms) {
    state.history.Push(ms * hal::kNsPerMs, JointsAt(0.0));
  }
  const model::Pose X_BC = CameraAt(0.0);
  const model::Vec3 target = X_BC * model::Vec3(0.02, 0.0, 0.4);
  hal::FeatureMeasurement not_found = Measure(0.0, target);
  not_found.found = false;
  hal::FeatureMeasurement wrong_dim = Measure(0.0, target);
  wrong_dim.dim = 2;
  hal::FeatureMeasurement too_old = Measure(0.0, target);
  too_old.stamp_ns = -hal::kNsPerSecond;
  hal::FeatureMeasurement behind = Measure(0.0, target);
  behind.s[2] = -10.0;
  hal::FeatureMeasurement future = Measure(0.0, target);
  future.stamp_ns = 120 * hal::kNsPerMs;
  const hal::FeatureMeasurement elsewhere = Measure(0.0, X_BC * model::Vec3(0.0, 0.0, 6.0));
  using hal::Intake;
  for (const auto& [m, intake] :
       {std::pair{not_found, Intake::kNotFound}, std::pair{wrong_dim, Intake::kWrongKind},
        std::pair{too_old, Intake::kTooOld}, std::pair{behind, Intake::kWrongKind},
        std::pair{future, Intake::kFromFuture}, std::pair{elsewhere, Intake::kOutOfRegion}}) {
    EXPECT_EQ(TakeMeasurement(config_, 100 * hal::kNsPerMs, m, state, eye_), intake);
    EXPECT_FALSE(Predict(config_, 100 * hal::kNsPerMs, X_BC, state).known);
    EXPECT_EQ(state.knowledge, Knowledge::kNone);
  }
}

// The target leaves its region. Measurements there are refused, and the prediction does not leave the region.
TEST_F(PredictTest, NothingIsAcceptedOrPredictedOutsideTheTargetRegion) {
  const auto target = [](double t) { return model::Vec3(0.55, 0.1 + 0.2 * t, 0.2 - 0.5 * t); };
  config_.predict.target_region.low.z() = -0.05;
  PredictState state;
  double lowest = 1.0;
  int refused = 0;
  double v_y = 0.0;
  for (int ms = 0; ms < 1000; ++ms) {
    state.history.Push(ms * hal::kNsPerMs, JointsAt(0.0));
    if (ms % 33 == 0) {
      hal::FeatureMeasurement m = Measure(0.0, target(1e-3 * ms));
      m.stamp_ns = ms * hal::kNsPerMs;
      refused += TakeMeasurement(config_, m.stamp_ns, m, state, eye_) == hal::Intake::kOutOfRegion ? 1 : 0;
    }
    const Prediction p = Predict(config_, ms * hal::kNsPerMs, CameraAt(0.0), state);
    if (p.known) {
      lowest = std::min(lowest, p.p_BO.z());
      EXPECT_TRUE(p.p_BO.z() > -0.05 || p.v_BO.z() >= 0.0);
      v_y = p.v_BO.y();
    }
  }
  EXPECT_EQ(lowest, -0.05);
  EXPECT_GE(refused, 14);
  EXPECT_NEAR(v_y, 0.2, 0.02) << "it moves on along the edge of the region";
}

TEST_F(PredictTest, KnowsTheTargetAfterEnoughMeasurements) {
  PredictState state;
  for (int ms = 0; ms < 400; ++ms) {
    state.history.Push(ms * hal::kNsPerMs, JointsAt(0.0));
  }
  const model::Pose X_BC = CameraAt(0.0);
  const model::Vec3 target = X_BC * model::Vec3(0.02, 0.0, 0.4);
  for (int i = 1; i <= config_.predict.accepted_min; ++i) {
    hal::FeatureMeasurement m = Measure(0.0, target);
    m.stamp_ns = i * 33 * hal::kNsPerMs;
    EXPECT_EQ(TakeMeasurement(config_, m.stamp_ns, m, state, eye_), hal::Intake::kTaken);
    const Prediction p = Predict(config_, m.stamp_ns, X_BC, state);
    EXPECT_EQ(p.known, i == config_.predict.accepted_min);
  }
}

// A frozen picture: the measurement moves with the camera. The first one is true. Once the hand has moved on,
// all others are rejected. When the camera works again, its measurements are taken again.
TEST_F(PredictTest, FrozenPictureIsRejected) {
  const model::Vec3 target(0.55, 0.1, 0.05);
  PredictState state;
  int taken = 0;
  int stuck = 0;
  double fastest = 0.0;
  hal::FeatureMeasurement frozen;
  for (int ms = 0; ms < 3000; ++ms) {
    const double t = 1e-3 * ms;
    const std::int64_t now = ms * hal::kNsPerMs;
    state.history.Push(now, JointsAt(t));
    if (ms % 33 != 0) {
      continue;
    }
    hal::FeatureMeasurement m = Measure(t, target);
    const bool freezes = ms >= 990 && ms < 1980;
    if (freezes) {
      frozen = ms == 990 ? m : frozen;
      const std::int64_t stamp_ns = m.stamp_ns;
      m = frozen;
      m.stamp_ns = stamp_ns;
      m.same_for_ns = stamp_ns - frozen.stamp_ns;
    }
    const hal::Intake intake = TakeMeasurement(config_, now, m, state, eye_);
    taken += intake == hal::Intake::kTaken ? 1 : 0;
    stuck += intake == hal::Intake::kStuckPicture ? 1 : 0;
    EXPECT_TRUE(freezes || intake == hal::Intake::kTaken) << ms;
    fastest = std::max(fastest, ms > 300 ? Predict(config_, now, CameraAt(t), state).v_BO.norm() : 0.0);
  }
  std::cout << taken << " taken, " << stuck << " stuck; estimated speed of the target at most " << fastest
            << " m/s\n";
  EXPECT_GE(stuck, 28);
  EXPECT_LT(fastest, 0.02);
}

// The picture of a target at rest stays the same while the arm rests, however long.
TEST_F(PredictTest, UnchangedPictureWithTheArmAtRestIsAccepted) {
  PredictState state;
  const model::Vec3 target = CameraAt(0.0) * model::Vec3(0.02, 0.0, 0.4);
  for (int ms = 0; ms < 5000; ++ms) {
    state.history.Push(ms * hal::kNsPerMs, JointsAt(0.0));
    if (ms % 33 == 0) {
      hal::FeatureMeasurement m = Measure(0.0, target);
      m.stamp_ns = ms * hal::kNsPerMs;
      m.same_for_ns = m.stamp_ns;
      ASSERT_EQ(TakeMeasurement(config_, m.stamp_ns, m, state, eye_), hal::Intake::kTaken);
    }
  }
}

// A hand that reverses at speed, with 0.1 mm of measurement noise: wrong stamps or a wrong mount make
// outliers of correct measurements, unless the filter allows for such errors.
TEST_F(PredictTest, KnownStampAndMountErrorsAreNoOutliers) {
  const auto joints_at = [](double t) {
    model::VecN q = test::Ready();
    for (int i = 0; i < 7; ++i) {
      const double phase = std::fmod(t / 0.7 + 0.1 * i, 2.0);
      q[i] += 0.25 * (phase < 1.0 ? phase : 2.0 - phase);  // to and fro at 0.36 rad/s
    }
    return q;
  };
  const model::Vec3 target(0.55, 0.1, 0.05);
  config::ServoConfig blind = config_;
  config_.predict.target_jerk = blind.predict.target_jerk = 0.2;
  blind.predict.stamp_sigma = blind.predict.mount_shift_sigma = blind.predict.mount_turn_sigma =
      blind.predict.scale_sigma = 0.0;
  for (const bool by_mount : {false, true}) {
    model::Pose X_EC = config_.X_EC;
    if (by_mount) {
      X_EC.R = X_EC.R * model::RotationOf({0.0, 5.0 * 0.0174533, 0.0});
    }
    std::array<int, 2> outliers{};
    for (std::size_t k = 0; k < 2; ++k) {
      const config::ServoConfig& config = k == 0 ? blind : config_;
      PredictState state;
      for (int ms = 0; ms < 6000; ++ms) {
        state.history.Push(ms * hal::kNsPerMs, joints_at(1e-3 * ms));
        if (ms % 33 != 0 || ms < 300) {
          continue;
        }
        model::ArmPoses poses;
        model::ComputePoses(config_.arm, joints_at(1e-3 * (by_mount ? ms : ms - 8)), poses);
        const model::Vec3 s = ((poses.X_BE * X_EC).Inverse() * target) / config_.feature.radius;
        hal::FeatureMeasurement m = Measure(0.0, target);
        for (std::size_t i = 0; i < 3; ++i) {
          m.s[i] = s[static_cast<Eigen::Index>(i)];
          m.cov_s[i * hal::kMaxFeatureDim + i] = 6e-6;
        }
        m.stamp_ns = ms * hal::kNsPerMs;
        outliers[k] += TakeMeasurement(config, m.stamp_ns, m, state, eye_) == hal::Intake::kOutlier ? 1 : 0;
      }
    }
    std::cout << (by_mount ? "mount 5 deg off: " : "stamps 8 ms off: ") << outliers[0]
              << " outliers with noise alone, " << outliers[1] << " with calibration errors allowed for\n";
    EXPECT_GT(outliers[0], 5);
    EXPECT_EQ(outliers[1], 0);
  }
}

// Three outliers in a row restart the filter. Meanwhile the servo goes on with the old estimate.
TEST_F(PredictTest, RestartedFilterCoastsOnTheOldEstimate) {
  PredictState state;
  const model::Vec3 target = CameraAt(0.0) * model::Vec3(0.02, 0.0, 0.4);
  const model::Vec3 moved = target + model::Vec3(0.1, 0.0, 0.0);
  std::int64_t newest_age_ns = 0;
  for (int k = 0; k < 40; ++k) {
    const std::int64_t now = k * 33 * hal::kNsPerMs;
    for (int ms = 0; ms < 33; ++ms) {
      state.history.Push(now - (32 - ms) * hal::kNsPerMs, JointsAt(0.0));
    }
    hal::FeatureMeasurement m = Measure(0.0, k < 20 ? target : moved);
    m.stamp_ns = now;
    (void)TakeMeasurement(config_, now, m, state, eye_);
    const Prediction p = Predict(config_, now, CameraAt(0.0), state);
    ASSERT_EQ(p.known, k + 1 >= config_.predict.accepted_min) << k;
    if (k >= 20 && k < 24) {
      EXPECT_LT((p.p_BO - target).norm(), 1e-4) << k;
      newest_age_ns = std::max(newest_age_ns, p.age_ns);
    }
    if (k == 39) {
      EXPECT_LT((p.p_BO - moved).norm(), 1e-3);
      EXPECT_EQ(p.age_ns, 0);
    }
  }
  EXPECT_EQ(newest_age_ns, 4 * 33 * hal::kNsPerMs) << "the old estimate ages";
}

}  // namespace
}  // namespace fovea::estimate
