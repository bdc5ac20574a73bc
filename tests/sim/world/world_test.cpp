// SPDX-License-Identifier: Apache-2.0
// The world: time, target, encoders, exposures, friction.
#include "sim/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <stdexcept>

#include "fovea/hal/types.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kMs = 1'000'000;

WorldConfig PandaWorld() {
  WorldConfig config;
  config.robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  config.q_start.resize(7);
  config.q_start << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
  return config;
}

TEST(TargetMotionTest, CircleIsLevelWithTheSetRadiusAndSpeed) {
  TargetMotion motion{MotionKind::kCircle, {0.5, 0.1, 0.04}, 0.10, 0.2};
  for (std::int64_t t = 0; t < 4'000 * kMs; t += 37 * kMs) {
    const Eigen::Vector3d p = PositionAt(motion, t);
    EXPECT_NEAR((p - motion.p_BO).norm(), 0.10, 1e-12);
    EXPECT_EQ(p.z(), 0.04);
    const Eigen::Vector3d v = (PositionAt(motion, t + 1000) - PositionAt(motion, t)) / 1e-6;
    EXPECT_NEAR(v.norm(), 0.2, 1e-6);
  }
  motion.kind = MotionKind::kStill;
  EXPECT_EQ(PositionAt(motion, 3'000 * kMs), motion.p_BO);
}

// Each path keeps its reach and its speed, comes near both limits, and has no step.
TEST(TargetMotionTest, EveryPathKeepsItsReachAndSpeed) {
  TargetMotion motion{MotionKind::kStill, {0.5, 0.1, 0.2}, 0.12, 0.2};
  motion.direction = Eigen::Vector3d(0.6, 0.8, 0.0);
  const auto look = [&](MotionKind kind) {
    motion.kind = kind;
    double far = 0.0;
    double fast = 0.0;
    for (std::int64_t t = 0; t < 60'000 * kMs; t += 13 * kMs) {
      far = std::max(far, (PositionAt(motion, t) - motion.p_BO).norm());
      fast = std::max(fast, (PositionAt(motion, t + kMs) - PositionAt(motion, t)).norm() / 1e-3);
    }
    return std::pair(far, fast);
  };
  for (const MotionKind kind : {MotionKind::kLine, MotionKind::kEight}) {
    const auto [far, fast] = look(kind);
    EXPECT_NEAR(far, 0.12, 0.001);
    EXPECT_NEAR(fast, 0.2, 0.002);
  }
  const auto [far, fast] = look(MotionKind::kWander);
  EXPECT_LE(far, 0.12);
  EXPECT_GT(far, 0.06);
  EXPECT_LE(fast, 0.2);
  EXPECT_GT(fast, 0.06);
  // A pendulum of 0.12 m: its bob stays at this distance from the pivot.
  motion.kind = MotionKind::kPendulum;
  const Eigen::Vector3d pivot = motion.p_BO + Eigen::Vector3d(0, 0, 0.12);
  for (std::int64_t t = 0; t < 2'000 * kMs; t += 7 * kMs) {
    EXPECT_NEAR((PositionAt(motion, t) - pivot).norm(), 0.12, 1e-12);
  }
}

TEST(TargetMotionTest, JumpsAtItsTimeAndTurnsAboutItsNormal) {
  TargetMotion motion;
  motion.kind = MotionKind::kJump;
  motion.jump = {0.0, -0.1, 0.0};
  motion.jump_s = 2.0;
  EXPECT_EQ(PositionAt(motion, 1'999 * kMs), motion.p_BO);
  EXPECT_EQ(PositionAt(motion, 2'000 * kMs), Eigen::Vector3d(motion.p_BO + motion.jump));
  motion.R_BO = Eigen::AngleAxisd(3.0, Eigen::Vector3d(0.6, 0.8, 0.0)).toRotationMatrix();
  motion.turn_rate = 0.5;
  const Eigen::Matrix3d R = OrientationAt(motion, 2'000 * kMs);
  EXPECT_LT((R.col(2) - motion.R_BO.col(2)).norm(), 1e-12);
  EXPECT_NEAR(R.col(0).dot(motion.R_BO.col(0)), std::cos(1.0), 1e-12);
}

TEST(WorldTest, EncodersHaveTheSetNoise) {
  WorldConfig config = PandaWorld();
  config.encoder_noise = 1e-5;
  config.velocity_noise = 2e-3;
  World world(config);
  double q2 = 0.0;
  double dq2 = 0.0;
  int count = 0;
  world.OnStep([&](const Truth& truth) {
    for (int i = 0; i < 7; ++i) {
      const auto k = static_cast<std::size_t>(i);
      q2 += std::pow(world.MeasuredState().q[k] - truth.q[i], 2);
      dq2 += std::pow(world.MeasuredState().dq[k] - truth.dq[i], 2);
      ++count;
    }
  });
  world.AdvanceTo(1'000 * kMs);
  EXPECT_NEAR(std::sqrt(q2 / count), 1e-5, 3e-7);
  EXPECT_NEAR(std::sqrt(dq2 / count), 2e-3, 6e-5);
}

// Under a step of torque, the arm with a drive moves as the ideal one does under the drive's torques.
TEST(WorldTest, DrivesDelayTheArmsMotion) {
  const TorqueDriveConfig slow{.bandwidth_hz = 50.0, .delay_s = 0.003};
  hal::ArmCommand command;
  command.num_joints = 7;
  command.tau_cmd[3] = 2.0;

  WorldConfig config = PandaWorld();
  World ideal(config);
  config.drives.assign(7, slow);
  World driven(config);
  driven.Command(command);
  std::vector<TorqueDrive> reference(7, TorqueDrive(slow));
  BulletArm arm(config.robot, config.physics);
  arm.SetState(config.q_start, Eigen::VectorXd::Zero(7));
  for (std::size_t i = 0; i < 7; ++i) {
    reference[i].Settle(arm.GravityTorque()[static_cast<Eigen::Index>(i)]);
  }
  double worst = 0.0;
  for (int k = 1; k <= 60; ++k) {
    // What is left of a command after the ideal arm's own gravity compensation.
    arm.SetState(ideal.truth().q, ideal.truth().dq);
    const Eigen::VectorXd gravity = arm.GravityTorque();
    hal::ArmCommand delivered;
    delivered.num_joints = 7;
    for (std::size_t i = 0; i < 7; ++i) {
      const double own = gravity[static_cast<Eigen::Index>(i)];
      delivered.tau_cmd[i] = reference[i].Step(own + command.tau_cmd[i], 0.0, 0.0) - own;
    }
    ideal.Command(delivered);
    ideal.AdvanceTo(k * kMs);
    driven.AdvanceTo(k * kMs);
    worst = std::max(worst, (ideal.truth().dq - driven.truth().dq).cwiseAbs().maxCoeff());
    if (k == 3) {
      EXPECT_LT(driven.truth().dq.cwiseAbs().maxCoeff(), 1e-9) << "still under way";
    }
  }
  std::cout << "speeds up to " << driven.truth().dq.cwiseAbs().maxCoeff() << " rad/s, apart by " << worst
            << '\n';
  EXPECT_GT(driven.truth().dq.cwiseAbs().maxCoeff(), 0.05);
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(driven.DriveError().cwiseAbs().maxCoeff(), 0.1) << "after 57 ms of a lag of 3 ms";
}

TEST(WorldTest, SpeedsComeFromTheMeasuredPositions) {
  WorldConfig config = PandaWorld();
  config.velocity_filter_hz = 30.0;
  config.encoder_noise = 1e-5;
  config.encoder_quantum = 5e-5;
  World world(config);
  hal::ArmCommand command;
  command.num_joints = 7;
  command.tau_cmd[0] = 1.0;
  world.Command(command);
  SpeedByDifferences own(30.0, 0.0);
  for (int k = 0; k <= 200; ++k) {
    world.AdvanceTo(k * kMs);
    EXPECT_EQ(world.MeasuredState().dq[0], own.Next(world.MeasuredState().q[0]));
  }
  EXPECT_GT(world.truth().dq[0], 0.1);
  EXPECT_NEAR(world.MeasuredState().dq[0], world.truth().dq[0], 0.1 * world.truth().dq[0]);
}

// Link-side sensors do not see what accelerates the rotor.
TEST(WorldTest, TorqueSensorsReadTheLinkSide) {
  WorldConfig config = PandaWorld();
  config.friction_compensation = 1.0;
  for (SimLink& link : config.robot.links) {
    link.rotor_inertia = link.dof == 6 ? 0.2 : 0.0;
  }
  World world(config);
  hal::ArmCommand command;
  command.num_joints = 7;
  command.tau_cmd[6] = 0.5;
  world.Command(command);
  world.AdvanceTo(1 * kMs);
  const double ddq = world.truth().dq[6] / 1e-3;
  BulletArm arm(config.robot, config.physics);
  arm.SetState(world.truth().q, world.truth().dq);
  EXPECT_GT(ddq, 2.0);
  EXPECT_NEAR(world.MeasuredState().tau_meas[6], arm.GravityTorque()[6] + 0.5 - 0.2 * ddq, 1e-9);
}

TEST(WorldTest, WorldRepeatsForTheSameSeedOnly) {
  WorldConfig config = PandaWorld();
  config.encoder_noise = 1e-5;
  const auto run = [&](std::uint64_t seed) {
    config.seed = seed;
    World world(config);
    world.AdvanceTo(100 * kMs);
    return world.MeasuredState().q;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

TEST(WorldTest, CameraKeepsItsRateAndItsOutage) {
  WorldConfig config = PandaWorld();
  config.camera_rate_hz = 30.0;
  config.camera_outage = {0.5, 0.8};
  World world(config);
  std::vector<Exposure> exposures;
  world.OnExposure([&](Exposure e) { exposures.push_back(std::move(e)); });
  world.AdvanceTo(2'000 * kMs);
  ASSERT_EQ(exposures.size(), 60U - 9U);
  for (const Exposure& e : exposures) {
    const double ideal_ns = 20e6 + static_cast<double>(e.sequence) * 1e9 / 30.0;
    EXPECT_LE(std::fabs(static_cast<double>(e.stamp_ns) - ideal_ns), 0.5e6 + 1.0) << "no drift";
    EXPECT_FALSE(e.stamp_ns >= 500 * kMs && e.stamp_ns < 800 * kMs);
  }
}

// A longer exposure is handed over when it has ended, with the moments around its middle. The exposure at
// 20 ms of an arm that moves shows it as it was at each of them.
TEST(WorldTest, LongExposureComesAtItsEndWithTheMomentsAroundIt) {
  WorldConfig config = PandaWorld();
  config.dq_start = Eigen::VectorXd::Constant(7, 0.1);
  config.exposure_reach_ns = 3'500'000;
  World world(config);
  std::vector<std::pair<std::int64_t, Exposure>> exposures;
  std::vector<Truth> truths;
  world.OnStep([&](const Truth& t) { truths.push_back(t); });
  world.OnExposure([&](Exposure e) { exposures.emplace_back(world.now_ns(), std::move(e)); });
  world.AdvanceTo(100 * kMs);
  ASSERT_EQ(exposures.size(), 3U);
  const auto& [at_ns, exposure] = exposures.front();
  EXPECT_EQ(exposure.stamp_ns, 20 * kMs);
  EXPECT_EQ(exposure.time_ns, 20 * kMs);
  EXPECT_EQ(at_ns, 24 * kMs);
  ASSERT_NE(exposure.around, nullptr);
  EXPECT_LE(exposure.around->front().time_ns, 16'500'000);
  EXPECT_GE(exposure.around->back().time_ns, 23'500'000);
  for (const Moment& moment : *exposure.around) {
    const Truth& truth = truths[static_cast<std::size_t>(moment.time_ns / kMs)];
    ASSERT_EQ(truth.stamp_ns, moment.time_ns);
    EXPECT_TRUE(moment.X_BC.isApprox(truth.X_BC, 0.0));
    EXPECT_EQ(moment.p_BO, truth.p_BO);
  }
  // Between two steps: the mean of both, and its orientation a turn half as far.
  const Eigen::Isometry3d before = truths[21].X_BC;
  const Eigen::Isometry3d after = truths[22].X_BC;
  const Moment between = exposure.At(1'500'000);
  EXPECT_LT((between.X_BC.translation() - 0.5 * (before.translation() + after.translation())).norm(), 1e-15);
  const Eigen::AngleAxisd first(before.linear().transpose() * between.X_BC.linear());
  const Eigen::AngleAxisd whole(before.linear().transpose() * after.linear());
  EXPECT_GT(whole.angle(), 1e-5) << "the camera does not turn";
  EXPECT_NEAR(first.angle(), 0.5 * whole.angle(), 1e-7 * whole.angle() + 1e-9);
  EXPECT_TRUE(exposure.At(-10 * kMs).X_BC.isApprox(exposure.around->front().X_BC, 0.0));
}

// An observer's exception does not pass through the loop: the clock closes and rethrows it on request.
TEST(WorldClockTest, ObserverExceptionClosesTheClockAndIsRethrownOnRequest) {
  World world(PandaWorld());
  LockstepClock clock(world, [](std::int64_t now_ns) -> bool {
    if (now_ns == 2 * kMs) {
      throw std::runtime_error("no more");
    }
    return true;
  });
  EXPECT_TRUE(clock.WaitUntil(kMs).ok());
  EXPECT_NO_THROW(clock.RethrowFailure());
  EXPECT_EQ(clock.WaitUntil(2 * kMs).code(), hal::StatusCode::kClosed);
  EXPECT_THROW(clock.RethrowFailure(), std::runtime_error);
}

// A link of 40 kg mm^2 under friction, which could reverse its velocity within a step of 1 ms.
TEST(WorldTest, LightLinkComesToRestUnderFriction) {
  WorldConfig config;
  config.robot = LoadSimRobot(test::RobotsFolder() + "/puma560.urdf", "puma560_base", "puma560_flange");
  config.q_start.resize(6);
  config.q_start << 0.2, 0.9, -3.75, 0.0, -0.3, 0.0;
  config.friction_compensation = 0.0;
  World world(config);
  hal::ArmCommand command;
  command.num_joints = 6;
  command.tau_cmd[5] = 0.15;
  world.Command(command);
  world.AdvanceTo(100 * kMs);
  EXPECT_GT(std::fabs(world.truth().dq[5]), 0.01) << "the joint did not move";
  command.tau_cmd[5] = 0.0;
  world.Command(command);
  world.AdvanceTo(1'100 * kMs);
  EXPECT_LT(world.truth().dq.cwiseAbs().maxCoeff(), 1e-3);
}

// A joint under friction, with partial and full compensation by its controller.
TEST(WorldTest, FrictionCompensationRestoresTheSpeedOfAJoint) {
  const auto speed_after = [](double compensation) {
    WorldConfig config = PandaWorld();
    config.friction_compensation = compensation;
    World world(config);
    hal::ArmCommand command;
    command.num_joints = 7;
    command.tau_cmd[0] = 2.0;
    world.Command(command);
    world.AdvanceTo(200 * kMs);
    return world.truth().dq[0];
  };
  EXPECT_GT(speed_after(1.0), 1.1 * speed_after(0.5));
  EXPECT_GT(speed_after(0.5), 1.1 * speed_after(0.0));
}

// Positions are multiples of the quantum, accurate to half of it; velocities are unchanged.
TEST(WorldTest, EncodersAreQuantised) {
  WorldConfig config = PandaWorld();
  config.dq_start = Eigen::VectorXd::Constant(7, 0.1);
  World fine(config);
  config.encoder_quantum = 1e-4;
  World coarse(config);
  int moved = 0;
  double before = coarse.MeasuredState().q[0];
  for (std::int64_t t = kMs; t <= 100 * kMs; t += kMs) {
    fine.AdvanceTo(t);
    coarse.AdvanceTo(t);
    EXPECT_EQ(fine.truth().q, coarse.truth().q);
    for (std::size_t k = 0; k < 7; ++k) {
      const double q = coarse.MeasuredState().q[k];
      EXPECT_NEAR(q / 1e-4, std::round(q / 1e-4), 1e-9);
      EXPECT_LE(std::fabs(q - fine.MeasuredState().q[k]), 0.5e-4 + 1e-12);
    }
    EXPECT_EQ(coarse.MeasuredState().dq, fine.MeasuredState().dq);
    moved += coarse.MeasuredState().q[0] != before ? 1 : 0;
    before = coarse.MeasuredState().q[0];
  }
  std::cout << "joint 1 changed in " << moved << " of 100 ticks\n";
  EXPECT_GT(moved, 20);
}

}  // namespace
}  // namespace fovea::sim
