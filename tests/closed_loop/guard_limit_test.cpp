// SPDX-License-Identifier: Apache-2.0
// Limits in closed loop: each is provoked, reported in time, and never exceeded by the arm in Bullet.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "firmware/core/model/ready_inertia.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "tests/closed_loop/guard_bench.hpp"
#include "tests/closed_loop/guard_provocations.hpp"

namespace fovea::test {
namespace {

using hal::Limit;
using hal::Mode;

constexpr double kStart = 0.3;  // provocations begin here, after Boot [s]
constexpr int kStartMs = 300;

Eigen::Vector3d Outward(const sim::Truth& truth) { return truth.X_BE.translation().normalized(); }

// An attack that ends after 1.2 s.
auto BriefAttack(const std::function<Eigen::Vector3d(const sim::Truth&)>& velocity) {
  return [attack = Attack(kStart, velocity)](const sim::Truth& truth, double t_s) {
    return t_s < kStart + 1.2 ? attack(truth, t_s) : moves::MotionCommand{};
  };
}

// The hand turns about its own z axis at `rate` [rad/s] and keeps its position.
auto Turn(double rate, const Eigen::Isometry3d& X_BE) {
  return [rate, X_BE](const sim::Truth&, double t_s) {
    moves::MotionCommand command;
    if (t_s < kStart) {
      return command;
    }
    const Eigen::Vector3d axis = X_BE.linear().col(2);
    const Eigen::Quaterniond hand(Eigen::AngleAxisd(rate * (t_s - kStart), axis) * X_BE.linear());
    const Eigen::Vector3d p = X_BE.translation();
    const Eigen::Vector3d w = rate * axis;
    command.kind = moves::MotionKind::kPoseSetpoint;
    command.p_BE = {p.x(), p.y(), p.z()};
    command.quaternion_BE = {hand.w(), hand.x(), hand.y(), hand.z()};
    command.V_BE_B = {0.0, 0.0, 0.0, w.x(), w.y(), w.z()};
    return command;
  };
}

Eigen::Isometry3d HandAt(const Eigen::VectorXd& q) {
  model::ArmPoses poses;
  model::ComputePoses(Panda().model, q, poses);
  Eigen::Isometry3d X_BE = Eigen::Isometry3d::Identity();
  X_BE.linear() = poses.X_BE.R;
  X_BE.translation() = poses.X_BE.p;
  return X_BE;
}

// Returns and prints when the limit was first reported after kStart [ms]; -1: never.
int Named(const GuardBench& bench, Limit limit) {
  const int named = bench.FirstLimit(limit, kStartMs);
  PrintFigures(std::string(hal::Name(limit)) + ": reported " + std::to_string(named - kStartMs) +
                   " ticks after the provocation began, mode " + hal::Name(bench.last().record.mode) + " " +
                   hal::Name(bench.last().record.hold_reason) + ", fault " +
                   hal::Name(bench.last().record.fault) + ", at rest after " +
                   std::to_string(bench.AtRest() - kStartMs),
               bench);
  return named;
}

bool StandsInHold(const GuardBench& bench) {
  return bench.last().record.mode == Mode::kHold && bench.speeds().back() < 0.01;
}

}  // namespace

// Joint 7 turns the hand towards the end of its range. No other joint can take over.
void ProvokeJointPosition() {
  GuardSetup setup;
  setup.world.q_start[6] = 2.2;
  setup.motion = Turn(0.5, HandAt(setup.world.q_start));
  GuardBench bench(setup);
  bench.RunUntil(5.0);
  const int named = Named(bench, Limit::kJointPosition);
  const model::Joint& joint = bench.config().arm.joints[6];
  const double end = joint.q_max - bench.config().guard.joint_position_margin;
  // In time: where a joint at this speed must begin to brake.
  const trajectory::JointPace pace = trajectory::PaceOf(bench.config(), 6);
  for (const GuardTick& tick : bench.ticks()) {
    EXPECT_LE(tick.record.q_cmd[6], end + 1e-9);
    if (tick.ms == named) {
      const double speed = tick.record.dq_cmd[6];
      const double way = speed * pace.reaction_s + 0.5 * speed * speed / pace.deceleration;
      std::cout << "the limit acted " << end - tick.record.q_cmd[6] << " rad before the end; braking needs "
                << way << '\n';
      EXPECT_NEAR(end - tick.record.q_cmd[6], way, 0.1 * way);
    }
  }
  EXPECT_TRUE(StandsInHold(bench));
  EXPECT_EQ(bench.last().record.hold_reason, hal::HoldReason::kMotionRefused);
  EXPECT_GT(bench.truth().q[6], end - 0.05) << "the joint reaches its end";
  ExpectInsideLimits(bench);
}

void ProvokeJointVelocity() {
  GuardSetup setup;
  setup.world.q_start[6] = -2.0;
  setup.servo.move.pose_error_max = 10.0;    // the hand may lag behind
  setup.servo.guard.rotation_speed = 100.0;  // only the joints limit the turn
  setup.motion = [turn = Turn(4.0, HandAt(setup.world.q_start))](const sim::Truth& truth, double t_s) {
    return t_s < 1.3 ? turn(truth, t_s) : moves::MotionCommand{};
  };
  GuardBench bench(setup);
  bench.RunUntil(2.0);
  EXPECT_EQ(Named(bench, Limit::kJointVelocity), kStartMs) << "in the tick of the command";
  const config::ServoConfig& config = bench.config();
  double most = 0.0;
  for (const GuardTick& tick : bench.ticks()) {
    for (std::size_t i = 0; i < 7; ++i) {
      const double share = std::fabs(tick.record.dq_cmd[i]) /
                           (config.guard.joint_velocity_fraction * config.arm.joints[i].dq_max);
      most = std::max(most, share);
    }
  }
  std::cout << "the reference used " << most << " of the speed allowed\n";
  EXPECT_LE(most, 1.0 + 1e-4) << "braking at full jerk ends slightly later";
  EXPECT_GT(most, 0.99);
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

namespace {

// A hand at rest is commanded to move sideways at 0.8 m/s from one tick to the next.
void ProvokeByJerk(Limit limit, double GuardFigures::*used) {
  GuardSetup setup;
  setup.motion = [attack = Attack(kStart, [](const sim::Truth&) { return Eigen::Vector3d(0, 0.8, 0); })](
                     const sim::Truth& truth, double t_s) {
    return t_s < 0.6 ? attack(truth, t_s) : moves::MotionCommand{};
  };
  GuardBench bench(setup);
  bench.RunUntil(1.5);
  EXPECT_EQ(Named(bench, limit), kStartMs) << "in the tick of the command";
  std::cout << "the reference used " << bench.figures().*used << " of what is allowed\n";
  EXPECT_GT(bench.figures().*used, 0.999);
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

}  // namespace

void ProvokeJointAcceleration() { ProvokeByJerk(Limit::kJointAcceleration, &GuardFigures::acceleration); }
void ProvokeJointJerk() { ProvokeByJerk(Limit::kJointJerk, &GuardFigures::jerk); }

// 1 m/s outward: the guard must slow the hand down in time. The hand stands when the attack ends.
void ProvokeWorkspace() {
  GuardSetup setup;
  setup.servo.move.pose_error_max = 10.0;
  setup.motion = BriefAttack([](const sim::Truth& truth) { return Outward(truth); });
  GuardBench bench(setup);
  bench.RunUntil(2.0);
  const int named = Named(bench, Limit::kWorkspace);
  EXPECT_GE(named, kStartMs);
  EXPECT_LT(named, kStartMs + 50) << "the hand starts 68 mm inside it";
  EXPECT_TRUE(StandsInHold(bench));
  const double boundary = bench.config().guard.workspace_radius;
  EXPECT_GT(bench.figures().radius, boundary - 0.01) << "the attack must come close to the limit";
  EXPECT_LE(bench.figures().radius, boundary + 1e-3);
  ExpectInsideLimits(bench);
}

// A motion that needs more torque than allowed. Each motor can accelerate its own joint as the guard allows,
// but not against the other joints.
void ProvokeTorque() {
  constexpr double kFraction = 0.5;
  GuardSetup setup;
  setup.servo.safety.torque_fraction = kFraction;
  model::ArmModel& arm = setup.servo.arm;
  const model::VecN inertia = model::InertiaAtReady(arm).held;
  for (int i = 0; i < arm.num_joints; ++i) {
    model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double need = inertia[i] * setup.servo.guard.joint_acceleration_fraction * joint.ddq_max;
    joint.tau_max = 1.01 * need / kFraction;
  }
  Eigen::VectorXd goal = setup.world.q_start;
  goal[0] += 1.0;
  goal[1] += 0.3;
  goal[3] -= 0.5;
  goal[5] += 0.5;
  setup.motion = GoTo(kStart, goal);
  GuardBench bench(setup);
  bench.RunUntil(3.0);
  const int named = Named(bench, Limit::kTorque);
  EXPECT_GT(named, kStartMs);
  EXPECT_LT(named, kStartMs + 200);
  EXPECT_GT(bench.figures().torque, kFraction * (1.0 - 1e-9));
  EXPECT_LT(bench.speeds().back(), 0.01);
  ExpectInsideLimits(bench);
}

// Measured velocities jump by no more than the servo accepts: the law asks for torque steps.
void ProvokeTorqueRate() {
  GuardSetup setup;
  setup.arm_faults.noise = {{kStart, kStart + 0.1}, 2e-4, 0.01};
  GuardBench bench(setup);
  bench.RunUntil(1.0);
  const int named = Named(bench, Limit::kTorqueRate);
  EXPECT_GE(named, kStartMs);
  EXPECT_LT(named, kStartMs + 5);
  EXPECT_GT(bench.figures().torque_rate, 1.0 - 1e-9);
  const double moved = (bench.truth().q - setup.world.q_start).cwiseAbs().maxCoeff();
  std::cout << "a joint moved by " << moved << " rad\n";
  EXPECT_LT(moved, 2e-3);
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

// 1 m/s down onto a plane above the table.
void ProvokeObstacle() {
  constexpr double kHeight = 0.35;
  GuardSetup setup;
  setup.servo.move.pose_error_max = 10.0;
  setup.servo.guard.obstacles.num_planes = 1;
  setup.servo.guard.obstacles.planes[0] = {model::Vec3::UnitZ(), kHeight};
  setup.motion = BriefAttack([](const sim::Truth&) { return Eigen::Vector3d(0, 0, -1.0); });
  GuardBench bench(setup);
  ASSERT_GT(bench.truth().X_BE.translation().z(), kHeight + 0.1);
  bench.RunUntil(2.0);
  const int named = Named(bench, Limit::kObstacle);
  EXPECT_GT(named, kStartMs);
  EXPECT_LT(named, kStartMs + 400);
  std::cout << "lowest " << bench.figures().lowest << " m, plane at " << kHeight << " m\n";
  EXPECT_GE(bench.figures().lowest, kHeight - 1e-3);
  // The last link's capsule, which reaches 34 mm beyond the flange, keeps its clearance.
  EXPECT_LT(bench.figures().lowest, kHeight + 0.034 + bench.config().guard.link_clearance + 0.01)
      << "the attack must come close to the limit";
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

void ProvokeCartesianSpeed() {
  constexpr double kSpeed = 0.3;
  GuardSetup setup;
  setup.servo.guard.cartesian_speed = kSpeed;
  setup.servo.move.pose_error_max = 10.0;
  setup.motion = [attack = Attack(kStart, [](const sim::Truth&) { return Eigen::Vector3d(0, 0.8, 0); })](
                     const sim::Truth& truth, double t_s) {
    return t_s < 0.9 ? attack(truth, t_s) : moves::MotionCommand{};
  };
  GuardBench bench(setup);
  bench.RunUntil(1.5);
  EXPECT_EQ(Named(bench, Limit::kCartesianSpeed), kStartMs) << "in the tick of the command";
  std::cout << "reference " << bench.figures().wished_speed << " m/s\n";
  EXPECT_GT(bench.figures().wished_speed, 0.9 * kSpeed);
  EXPECT_LE(bench.figures().wished_speed, 1.02 * kSpeed);
  EXPECT_LE(bench.figures().speed, 1.05 * kSpeed);
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

// The hand is commanded to turn about its own axis faster than allowed.
void ProvokeRotationSpeed() {
  constexpr double kTurn = 1.0;
  GuardSetup setup;
  setup.servo.guard.rotation_speed = kTurn;
  setup.servo.move.pose_error_max = 10.0;
  setup.world.q_start[6] = -1.0;
  setup.motion = [turn = Turn(1.5, HandAt(setup.world.q_start))](const sim::Truth& truth, double t_s) {
    return t_s < 1.3 ? turn(truth, t_s) : moves::MotionCommand{};
  };
  GuardBench bench(setup);
  bench.RunUntil(2.0);
  EXPECT_EQ(Named(bench, Limit::kRotationSpeed), kStartMs) << "in the tick of the command";
  std::cout << "reference " << bench.figures().wished_turn << " rad/s, hand " << bench.figures().turn
            << " rad/s\n";
  EXPECT_GT(bench.figures().wished_turn, 0.88 * kTurn);
  EXPECT_LE(bench.figures().wished_turn, 0.9 * kTurn);
  EXPECT_LE(bench.figures().turn, kTurn);
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

// Outward at 1 m/s with the boundary out of reach, until the elbow is almost straight.
void ProvokeSingularity() {
  GuardSetup setup;
  setup.servo.guard.workspace_radius = 2.0;
  setup.servo.move.pose_error_max = 10.0;
  setup.motion = BriefAttack([](const sim::Truth& truth) { return Outward(truth); });
  GuardBench bench(setup);
  bench.RunUntil(2.0);
  const int named = Named(bench, Limit::kSingularity);
  EXPECT_GT(named, kStartMs);
  std::cout << "smallest singular value " << bench.figures().singular << '\n';
  EXPECT_GE(bench.figures().singular, 0.95 * bench.config().guard.singularity_min);
  EXPECT_LT(bench.figures().singular, 3.0 * bench.config().guard.singularity_min)
      << "the attack must come close to the limit";
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

// A goal at which a part of the ball would be outside the picture.
void ProvokeFieldOfView() {
  GuardSetup setup;
  constexpr double kEdge = 0.40;
  setup.servo.auto_track = true;
  setup.servo.guard.view = {true, -kEdge, kEdge, -0.35, 0.35};
  setup.servo.feature.p_CO_C_star = {0.14, 0.0, 0.40};
  const model::Pose& mount = setup.servo.X_EC;
  Eigen::Isometry3d X_EC = Eigen::Isometry3d::Identity();
  X_EC.linear() = mount.R;
  X_EC.translation() = mount.p;
  const Eigen::Vector3d p_BO = HandAt(setup.world.q_start) * X_EC * Eigen::Vector3d(0.0, 0.0, 0.5);
  setup.target = [p_BO](double) { return p_BO; };
  GuardBench bench(setup);
  bench.RunUntil(6.0);
  Named(bench, Limit::kFieldOfView);
  EXPECT_GT(bench.FirstLimit(Limit::kFieldOfView), 0);
  const Eigen::Vector3d p = (bench.truth().X_BE * X_EC).inverse() * p_BO;
  const double edge = (p.x() + setup.servo.feature.radius) / p.z();
  std::cout << "the ball's edge is at " << edge << ", the picture's at " << kEdge << '\n';
  EXPECT_LT(edge, kEdge + 0.005);
  EXPECT_GT(edge, kEdge - 0.02) << "the attack must come close to the limit";
  EXPECT_EQ(bench.last().record.hold_reason, hal::HoldReason::kGoalUnreachable);
  EXPECT_TRUE(StandsInHold(bench));
  ExpectInsideLimits(bench);
}

}  // namespace fovea::test
