// SPDX-License-Identifier: Apache-2.0
// Each fault acts as described within its window and not outside it, and repeats for the same seed.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/robots/robot.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/faulty_detector.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/world/world.hpp"
#include "tests/support/fake_drivers.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kMs = hal::kNsPerMs;

// The states of 100 ms from a turning arm, read through `faults`.
struct Reading {
  bool came = false;
  hal::ArmState state;
};
std::vector<Reading> ReadThrough(const ArmFaults& faults) {
  test::FakeArm inner(2);
  FaultyArm arm(inner, faults);
  std::vector<Reading> readings;
  for (int tick = 0; tick < 100; ++tick) {
    inner.state.stamp_ns = tick * kMs;
    inner.state.sequence = static_cast<std::uint64_t>(tick);
    inner.state.q = {0.01 * tick, 1.0};
    inner.state.dq = {10.0, 0.5};
    Reading reading;
    reading.came = arm.Read(reading.state).ok();
    readings.push_back(reading);
  }
  return readings;
}

bool InWindow(int tick) { return tick >= 20 && tick < 50; }
constexpr TimeWindow kWindow{0.020, 0.050};

TEST(FaultyArmTest, StuckEncoderKeepsItsReadingWithZeroVelocity) {
  ArmFaults faults;
  faults.stuck = {kWindow, 0};
  const auto readings = ReadThrough(faults);
  for (int tick = 0; tick < 100; ++tick) {
    const hal::ArmState& state = readings[static_cast<std::size_t>(tick)].state;
    EXPECT_EQ(state.q[0], InWindow(tick) ? 0.20 : 0.01 * tick) << tick;
    EXPECT_EQ(state.dq[0], InWindow(tick) ? 0.0 : 10.0);
    EXPECT_EQ(state.q[1], 1.0) << "the other joint is unaffected";
    EXPECT_EQ(state.dq[1], 0.5);
  }
}

TEST(FaultyArmTest, AllEncodersStuckTogetherWhileStampsGoOn) {
  ArmFaults faults;
  faults.stuck = {kWindow, kAllJoints};
  const auto readings = ReadThrough(faults);
  for (int tick = 0; tick < 100; ++tick) {
    const hal::ArmState& state = readings[static_cast<std::size_t>(tick)].state;
    EXPECT_EQ(state.q[0], InWindow(tick) ? 0.20 : 0.01 * tick) << tick;
    EXPECT_EQ(state.q[1], 1.0);
    EXPECT_EQ(state.dq[0], InWindow(tick) ? 0.0 : 10.0);
    EXPECT_EQ(state.dq[1], InWindow(tick) ? 0.0 : 0.5);
    EXPECT_EQ(state.stamp_ns, tick * kMs);
    EXPECT_EQ(state.sequence, static_cast<std::uint64_t>(tick));
  }
}

TEST(FaultyArmTest, NoiseBurstHasTheSetDeviations) {
  ArmFaults faults;
  faults.noise = {{0.0, 1e3}, 2e-3, 0.1};
  test::FakeArm inner(7);
  FaultyArm arm(inner, faults);
  double q2 = 0.0;
  double dq2 = 0.0;
  constexpr int kTicks = 2000;
  for (int tick = 0; tick < kTicks; ++tick) {
    inner.state.stamp_ns = tick * kMs;
    hal::ArmState state;
    ASSERT_TRUE(arm.Read(state).ok());
    for (std::size_t k = 0; k < 7; ++k) {
      q2 += state.q[k] * state.q[k];
      dq2 += state.dq[k] * state.dq[k];
    }
    EXPECT_EQ(state.q[7], 0.0) << "entries beyond the last joint stay 0";
  }
  const double q_rms = std::sqrt(q2 / (7 * kTicks));
  const double dq_rms = std::sqrt(dq2 / (7 * kTicks));
  std::cout << "deviations " << q_rms << " rad, " << dq_rms << " rad/s\n";
  EXPECT_NEAR(q_rms, 2e-3, 4e-5);
  EXPECT_NEAR(dq_rms, 0.1, 2e-3);
}

TEST(FaultyArmTest, NanReadingOccursOnlyWithinItsWindow) {
  ArmFaults faults;
  faults.not_a_number = {kWindow, 1};
  const auto readings = ReadThrough(faults);
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_EQ(std::isnan(readings[static_cast<std::size_t>(tick)].state.q[1]), InWindow(tick)) << tick;
  }
}

TEST(FaultyArmTest, StampsJumpOnlyWithinTheirWindow) {
  ArmFaults faults;
  faults.clock_jump = {kWindow, -7 * kMs};
  const auto readings = ReadThrough(faults);
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_EQ(readings[static_cast<std::size_t>(tick)].state.stamp_ns,
              (InWindow(tick) ? tick - 7 : tick) * kMs);
  }
}

TEST(FaultyArmTest, StateLossRepeatsForTheSameSeed) {
  const auto lost = [](std::uint64_t seed, double share) {
    ArmFaults faults;
    faults.packet_loss = {kWindow, share};
    faults.seed = seed;
    std::vector<int> ticks;
    const auto readings = ReadThrough(faults);
    for (int tick = 0; tick < 100; ++tick) {
      if (!readings[static_cast<std::size_t>(tick)].came) {
        ticks.push_back(tick);
        EXPECT_TRUE(InWindow(tick));
      }
    }
    return ticks;
  };
  EXPECT_EQ(lost(1, 1.0).size(), 30U);
  EXPECT_EQ(lost(1, 0.0).size(), 0U);
  EXPECT_GT(lost(1, 0.5).size(), 5U);
  EXPECT_LT(lost(1, 0.5).size(), 25U);
  EXPECT_EQ(lost(1, 0.5), lost(1, 0.5));
  EXPECT_NE(lost(1, 0.5), lost(2, 0.5));
}

TEST(StallingClockTest, WaitsPastTheSwallowedTicks) {
  test::FakeClock inner;
  StallingClock clock(inner, {kWindow, 1.0, 1});
  ASSERT_TRUE(clock.WaitUntil(19 * kMs).ok());
  EXPECT_EQ(clock.NowNs(), 19 * kMs);
  ASSERT_TRUE(clock.WaitUntil(20 * kMs).ok());
  EXPECT_EQ(clock.NowNs(), 50 * kMs);
  ASSERT_TRUE(clock.WaitUntil(51 * kMs).ok());
  EXPECT_EQ(clock.NowNs(), 51 * kMs);
}

// Otherwise a window that outlasts the run would keep it from ending.
TEST(StallingClockTest, MissesNoTickAfterTheEnd) {
  test::FakeClock inner;
  StallingClock clock(inner, {{0.020, 0.1}, 1.0, 1});
  clock.EndAt(30 * kMs);
  ASSERT_TRUE(clock.WaitUntil(20 * kMs).ok());
  EXPECT_EQ(clock.NowNs(), 30 * kMs);
  ASSERT_TRUE(clock.WaitUntil(31 * kMs).ok());
  EXPECT_EQ(clock.NowNs(), 31 * kMs);
}

TEST(FrameSpoilerTest, LosesFreezesAndDelaysFramesWithinTheirWindows) {
  FrameFaults faults;
  faults.loss = {{1.0, 2.0}, 0.5};
  faults.freeze = {3.0, 4.0};
  faults.late = {{5.0, 6.0}, 30 * kMs};
  FrameSpoiler spoiler(faults);
  int lost = 0;
  for (std::uint64_t frame = 0; frame < 700; ++frame) {
    Exposure exposure;
    exposure.sequence = frame;
    exposure.stamp_ns = static_cast<std::int64_t>(frame) * 10 * kMs;
    exposure.p_BO.x() = static_cast<double>(frame);
    const double t_s = 0.01 * static_cast<double>(frame);
    const std::optional<Exposure> taken = spoiler.Spoil(exposure);
    lost += taken ? 0 : 1;
    EXPECT_TRUE(taken || (t_s >= 1.0 && t_s < 2.0)) << t_s;
    if (taken) {
      EXPECT_EQ(taken->sequence, frame);
      EXPECT_EQ(taken->stamp_ns, exposure.stamp_ns) << "the frame has a new stamp";
      EXPECT_EQ(taken->p_BO.x(), t_s >= 3.0 && t_s < 4.0 ? 300.0 : exposure.p_BO.x());
    }
    EXPECT_EQ(spoiler.DelayNs(exposure.stamp_ns), t_s >= 5.0 && t_s < 6.0 ? 30 * kMs : 0);
  }
  std::cout << lost << " of 100 frames lost at a share of 0.5\n";
  EXPECT_NEAR(lost, 50, 15);
}

TEST(FaultyDetectorTest, ShiftsAndSpoilsOnlyFoundFeatures) {
  struct Last final : hal::FeatureSink {
    void Put(const hal::FeatureMeasurement& m) noexcept override { measurement = m; }
    hal::FeatureMeasurement measurement;
  } sink;
  DetectorFaults faults;
  faults.wrong = {{1.0, 2.0}, 1.0, {0.5, -0.25}};
  faults.not_a_number = {3.0, 4.0};
  FaultyDetector detector(sink, faults);
  hal::FeatureMeasurement m;
  m.found = true;
  m.dim = 3;
  m.s = {1.0, 2.0, 8.0};
  const auto said = [&](double t_s) {
    m.stamp_ns = static_cast<std::int64_t>(t_s * 1e9);
    ++m.sequence;
    detector.Put(m);
    return sink.measurement.s;
  };
  EXPECT_EQ(said(0.5), m.s);
  EXPECT_EQ(said(1.5), (std::array<double, hal::kMaxFeatureDim>{1.5, 1.75, 8.0}));
  EXPECT_TRUE(std::isnan(said(3.5)[0]));
  m.found = false;
  EXPECT_EQ(said(1.5), m.s) << "a measurement without target is not changed";
}

TEST(PictureFaultsTest, GlareAndOccluderAppearAtTheirPlaces) {
  constexpr int kWidth = 64;
  constexpr int kHeight = 48;
  PictureFaults faults;
  faults.glare = {{1.0, 2.0}, 20.0, 10.0, 5.0};
  faults.occluder = {{1.0, 2.0}, 62.0, 24.0, 10.0, 100.0};  // partly outside the picture
  const auto draw = [&](std::int64_t stamp_ns) {
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(kWidth * kHeight) * 4, 100);
    SpoilPicture(faults, stamp_ns, kWidth, rgba);
    return rgba;
  };
  const auto untouched = draw(500 * kMs);
  EXPECT_TRUE(std::all_of(untouched.begin(), untouched.end(), [](std::uint8_t v) { return v == 100; }));
  const auto rgba = draw(1500 * kMs);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const int value = rgba[static_cast<std::size_t>(4 * (v * kWidth + u))];
      const double distance = std::hypot(u - 20.0, v - 10.0);
      if (distance <= 5.0) {
        EXPECT_EQ(value, 255);
      } else if (u >= 57) {
        EXPECT_LT(value, 30);
      } else if (distance >= 7.5) {
        EXPECT_EQ(value, 100);
      } else {
        EXPECT_GT(value, 100) << "the glare fades out";
      }
    }
  }
}

class BenchFaultTest : public testing::Test {
 protected:
  BenchFaultTest() : robot_(robots::LoadRobot(test::RobotsFolder() + "/panda.toml")) {
    config_.robot = LoadSimRobot(robot_.urdf, robot_.base_link, robot_.tip_link);
    config_.q_start.resize(7);
    config_.q_start << 0.1, -0.7, 0.2, -2.2, 0.3, 1.6, 0.7;
    config_.friction_compensation = 1.0;
  }
  robots::Robot robot_;
  WorldConfig config_;
};

// Joint 2's motor gives half of its torque: the other half of
// the holding torque is missing, and nothing else changes.
TEST_F(BenchFaultTest, WeakMotorAcceleratesTheArmByTheMissingTorque) {
  BulletArm reference(config_.robot, {});
  reference.SetState(config_.q_start, Eigen::VectorXd::Zero(7));
  Eigen::VectorXd tau = reference.GravityTorque();
  tau[1] *= 0.5;
  const Eigen::VectorXd ddq = reference.ForwardDynamics(tau);

  config_.torque_loss = {{0.010, 1.0}, 1, 0.5};
  World world(config_);
  world.AdvanceTo(10 * kMs);
  EXPECT_LT(world.truth().dq.norm(), 1e-9) << "at rest before the fault";
  world.AdvanceTo(11 * kMs);
  const double off = (1e3 * world.truth().dq - ddq).norm() / ddq.norm();
  std::cout << "acceleration " << ddq.norm() << " rad/s^2, relative error " << off << "\n";
  EXPECT_LT(off, 1e-8);
  EXPECT_LT((world.truth().ddq_disturbed - ddq).norm(), 1e-6 * ddq.norm())
      << "all of it is attributed to the fault";
  EXPECT_NEAR(world.MeasuredState().tau_meas[1], 0.5 * reference.GravityTorque()[1], 0.05)
      << "the torque sensor on the link side measures it";
}

// A tilted base: M ddq is the change of the gravity torques, from the masses and their positions.
TEST_F(BenchFaultTest, TiltedBaseAcceleratesTheArmAsComputed) {
  constexpr double kTilt = 0.1;
  constexpr double kWeight = 9.81;
  const model::VecN q = config_.q_start;
  const model::VecN rest = model::VecN::Zero(7);
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(robot_.model, q, poses);
  model::ComputeDynamics(robot_.model, poses, rest, dynamics);
  // In the base's axes the gravity vector turns by -kTilt about x.
  const Eigen::Vector3d change(0.0, -kWeight * std::sin(kTilt), kWeight * (1.0 - std::cos(kTilt)));
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(7);
  BulletArm arm(config_.robot, {});
  arm.SetState(config_.q_start, Eigen::VectorXd::Zero(7));
  const auto coms = [&](const Eigen::VectorXd& at) {  // sum of mass times position over all links
    arm.SetState(at, Eigen::VectorXd::Zero(7));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 1; i < static_cast<int>(config_.robot.links.size()); ++i) {
      const SimLink& link = config_.robot.links[static_cast<std::size_t>(i)];
      sum += link.mass * (arm.LinkPose(i) * link.X_LCom.translation());
    }
    return sum;
  };
  constexpr double kTurn = 1e-5;
  for (int joint = 0; joint < 7; ++joint) {
    const Eigen::VectorXd turn = kTurn * Eigen::VectorXd::Unit(7, joint);
    tau[joint] = change.dot(coms(config_.q_start + turn) - coms(config_.q_start - turn)) / (2.0 * kTurn);
  }
  const Eigen::VectorXd ddq = Eigen::MatrixXd(dynamics.M).ldlt().solve(tau);

  config_.base_tilt = {{0.010, 0.020}, kTilt};
  World world(config_);
  world.AdvanceTo(10 * kMs);
  EXPECT_LT(world.truth().dq.norm(), 1e-9) << "at rest before the fault";
  world.AdvanceTo(11 * kMs);
  const double off = (1e3 * world.truth().dq - ddq).norm() / ddq.norm();
  std::cout << "acceleration " << ddq.norm() << " rad/s^2, relative error " << off << "\n";
  EXPECT_LT(off, 1e-6);
  EXPECT_LT((world.truth().ddq_disturbed - ddq).norm(), 1e-6 * ddq.norm())
      << "all of it is attributed to the fault";
  world.AdvanceTo(20 * kMs);
  const Eigen::VectorXd dq = world.truth().dq;
  world.AdvanceTo(25 * kMs);
  EXPECT_LT((world.truth().dq - dq).norm(), 0.05 * dq.norm()) << "the base is upright again";
}

TEST_F(BenchFaultTest, LoadFromTheStartActsInTheFirstStep) {
  config_.load = {{0.0, 1.0}, 2.0};
  World world(config_);
  world.AdvanceTo(1 * kMs);
  const Eigen::VectorXd first = world.truth().dq;
  config_.load = {{0.010, 1.0}, 2.0};
  World later(config_);
  later.AdvanceTo(11 * kMs);
  std::cout << "speed after a step " << first.norm() << " rad/s\n";
  EXPECT_GT(first.norm(), 1e-3);
  EXPECT_LT((first - later.truth().dq).norm(), 1e-9);
}

// An unknown mass at the hand: (M + m J^T J) ddq = m J^T g, from the servo's own model.
TEST_F(BenchFaultTest, LoadActsAsAPointMassAtTheHand) {
  constexpr double kMass = 2.0;
  const model::VecN q = config_.q_start;
  const model::VecN rest = model::VecN::Zero(7);
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::LinearJacobian J;
  model::ComputePoses(robot_.model, q, poses);
  model::ComputeDynamics(robot_.model, poses, rest, dynamics);
  model::ComputeLinearJacobian(robot_.model, poses, poses.X_BE.p, J);
  const Eigen::MatrixXd M = Eigen::MatrixXd(dynamics.M) + kMass * J.transpose() * J;
  const Eigen::VectorXd weight = kMass * J.transpose() * Eigen::Vector3d(0, 0, -9.81);
  const Eigen::VectorXd ddq = M.ldlt().solve(weight);

  config_.load = {{0.010, 0.020}, kMass};
  World world(config_);
  world.AdvanceTo(10 * kMs);
  EXPECT_LT(world.truth().dq.norm(), 1e-9) << "at rest before the fault";
  world.AdvanceTo(11 * kMs);
  const double off = (1e3 * world.truth().dq - ddq).norm() / ddq.norm();
  std::cout << "acceleration " << ddq.norm() << " rad/s^2, relative error " << off << "\n";
  EXPECT_LT(off, 1e-8);
  EXPECT_LT((world.truth().ddq_disturbed - ddq).norm(), 1e-6 * ddq.norm())
      << "all of it is attributed to the fault";
  // After the window the arm keeps its speed, except for the effects of its changing posture.
  world.AdvanceTo(20 * kMs);
  const Eigen::VectorXd dq = world.truth().dq;
  world.AdvanceTo(25 * kMs);
  EXPECT_LT((world.truth().dq - dq).norm(), 0.05 * dq.norm());
}

}  // namespace
}  // namespace fovea::sim
