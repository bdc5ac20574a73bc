// From measurements that are old when they come to where the target is now.
#include "fovea/servo/predict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "support/panda.hpp"
#include "support/random_states.hpp"

namespace fovea::servo {
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

  ServoConfig config_ = test::PandaConfig();
};

// A target on a circle, a camera that moves, measurements 40 ms old at 30 Hz: the prediction is where the
// target is now, and the newest measurement as it came is not.
TEST_F(PredictTest, MakesUpForTheLatencyWhileCameraAndTargetMove) {
  const auto target = [](double t) {
    return model::Vec3(0.55 + 0.1 * std::cos(2.0 * t), 0.1 * std::sin(2.0 * t), 0.05);
  };
  PredictState state;
  PredictState state_held;
  ServoConfig held = config_;
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
    const Prediction p = Predict(config_, now, CameraAt(t), arrives ? &m : nullptr, state);
    const Prediction h = Predict(held, now, CameraAt(t), arrives ? &m : nullptr, state_held);
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

TEST_F(PredictTest, LeavesOutWhatSaysNothing) {
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
  for (const auto& m : {not_found, wrong_dim, too_old, behind}) {
    EXPECT_FALSE(Predict(config_, 100 * hal::kNsPerMs, X_BC, &m, state).known);
    EXPECT_FALSE(state.has_accepted);
  }
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
    const Prediction p = Predict(config_, m.stamp_ns, X_BC, &m, state);
    EXPECT_EQ(p.known, i == config_.predict.accepted_min);
  }
}

}  // namespace
}  // namespace fovea::servo
