// SPDX-License-Identifier: Apache-2.0
#include "tests/closed_loop/guard_bench.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iostream>

#include "firmware/core/model/kinematics.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::test {
namespace {

constexpr double kTickS = hal::kTickPeriodS;
constexpr double kLength = 0.3;   // lever arm that converts radians to metres [m]
constexpr double kAtRest = 0.01;  // [rad/s]
constexpr std::int64_t kLatencyNs = 40 * hal::kNsPerMs;

int Ms(std::int64_t ns) { return static_cast<int>(ns / hal::kNsPerMs); }

const sim::SimRobot& PandaBody() {
  static const sim::SimRobot robot = sim::LoadSimRobot(Panda().urdf, Panda().base_link, Panda().tip_link);
  return robot;
}

void Use(double& most, double now) { most = std::max(most, std::fabs(now)); }

}  // namespace

GuardSetup::GuardSetup() : servo(PandaConfig()) {
  world.robot = PandaBody();
  world.q_start.resize(7);
  world.q_start << -0.30, -0.75, 0.0, -2.05, 0.0, 1.55, 0.485398;
  world.X_EC.linear() = servo.X_EC.R;
  world.X_EC.translation() = servo.X_EC.p;
  world.encoder_noise = 1e-5;
  world.velocity_noise = 5e-4;
  servo.auto_track = false;
}

void TellTheBench(config::ServoConfig& servo) {
  config::GuardConfig& guard = servo.guard;
  guard.obstacles.num_planes = 1;
  guard.obstacles.planes[0] = {model::Vec3::UnitZ(), 0.01};
  static_cast<void>(guard.hand.AddCapsule(model::Vec3::Zero(), servo.X_EC.p, 0.03));
  guard.view = {true, -0.56, 0.56, -0.41, 0.41, 0.0};
}

GuardBench::GuardBench(GuardSetup setup)
    : setup_(std::move(setup)),
      world_(setup_.world),
      arm_(world_),
      faulty_arm_(arm_, setup_.arm_faults),
      clock_(world_,
             [this](std::int64_t now_ns) {
               HandOver(now_ns);
               plans_.Act(now_ns);
               return true;
             }),
      stalling_(clock_, setup_.stall),
      recorder_(*this),
      motion_(*this),
      plans_(setup_.servo),
      loop_(task_, faulty_arm_, stalling_, mailbox_, recorder_, probe_),
      p_before_(world_.truth().X_BE.translation()),
      R_before_(world_.truth().X_BE.linear()) {
  const hal::Status status = task_.Init(setup_.servo);
  EXPECT_TRUE(status.ok()) << status.where();
  world_.OnStep([this](const sim::Truth& truth) { Watch(truth); });
  world_.OnExposure([this](const sim::Exposure& exposure) { See(exposure); });
  loop_.UseMotion(motion_);
  loop_.UsePlanner(plans_.box());
}

void GuardBench::RunUntil(double t_s) {
  const hal::Status status = loop_.Run(static_cast<std::int64_t>(std::llround(t_s * 1e9)));
  EXPECT_TRUE(status.ok());
  clock_.RethrowFailure();
}

void GuardBench::Watch(const sim::Truth& truth) {
  GuardFigures& f = figures_;
  const model::ArmModel& arm = setup_.servo.arm;
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    Use(f.torque, truth.tau_cmd[i] / joint.tau_max);
    if (tau_before_.size() > 0) {
      Use(f.torque_rate, (truth.tau_cmd[i] - tau_before_[i]) / (joint.dtau_max * kTickS));
    }
    Use(f.position, (truth.q[i] - 0.5 * (joint.q_max + joint.q_min)) / (0.5 * (joint.q_max - joint.q_min)));
    Use(f.velocity, truth.dq[i] / joint.dq_max);
  }
  tau_before_ = truth.tau_cmd;
  const Eigen::Vector3d p = truth.X_BE.translation();
  Use(f.radius, p.norm());
  Use(f.speed, (p - p_before_).norm() / kTickS);
  f.lowest = std::min(f.lowest, p.z());
  p_before_ = p;
  const Eigen::Matrix3d R = truth.X_BE.linear();
  Use(f.turn, Eigen::AngleAxisd(R_before_.transpose() * R).angle() / kTickS);
  R_before_ = R;
  speeds_.push_back(truth.dq.cwiseAbs().maxCoeff());
}

void GuardBench::WatchReference(const hal::TickRecord& record) {
  const auto runs = [](hal::Mode mode) { return mode != hal::Mode::kBoot && mode != hal::Mode::kFault; };
  if (!runs(record.mode)) {
    return;  // the reference is where the arm is
  }
  const model::ArmModel& arm = setup_.servo.arm;
  const config::GuardConfig& guard = setup_.servo.guard;
  const bool ran_on = !ticks_.empty() && runs(ticks_.back().record.mode);
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    Use(figures_.acceleration, record.ddq_cmd[k] / (guard.joint_acceleration_fraction * joint.ddq_max));
    if (ran_on) {
      Use(figures_.jerk, (record.ddq_cmd[k] - ticks_.back().record.ddq_cmd[k]) /
                             (guard.joint_jerk_fraction * joint.dddq_max * kTickS));
    }
  }
  const model::VecN q = model::ToVector(record.q_cmd, arm.num_joints);
  model::ArmPoses poses;
  model::Mat6N J;
  model::ComputePoses(arm, q, poses);
  model::ComputeJacobian(arm, poses, model::Pose{}, J);
  Use(figures_.wished_turn,
      model::AngularVelocity(arm, poses, model::ToVector(record.dq_cmd, arm.num_joints)).norm());
  Use(figures_.wished_speed, (J.topRows<3>() * model::ToVector(record.dq_cmd, arm.num_joints)).norm());
  J.topRows<3>() /= kLength;
  const Eigen::Matrix<double, 6, 6> JJt = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> squares(JJt, Eigen::EigenvaluesOnly);
  figures_.singular = std::min(figures_.singular, std::sqrt(std::max(squares.eigenvalues().minCoeff(), 0.0)));
}

void GuardBench::Recorder::Record(const hal::TickRecord& record) noexcept {
  bench.WatchReference(record);
  bench.ticks_.push_back({Ms(bench.world_.now_ns()), record});
}

moves::MotionCommand GuardBench::Motion::At(std::int64_t) noexcept {
  return bench.setup_.motion
             ? bench.setup_.motion(bench.world_.truth(), static_cast<double>(bench.world_.now_ns()) * 1e-9)
             : moves::MotionCommand{};
}

void GuardBench::See(const sim::Exposure& exposure) {
  if (!setup_.target) {
    return;
  }
  constexpr double kNoise = 1e-3;  // of s, in radii
  std::normal_distribution<double> normal(0.0, kNoise);
  hal::FeatureMeasurement m;
  m.stamp_ns = exposure.stamp_ns;
  m.sequence = exposure.sequence;
  m.found = true;
  m.confidence = 1.0;
  m.dim = 3;
  const Eigen::Vector3d s = exposure.X_BC.inverse() *
                            setup_.target(static_cast<double>(exposure.stamp_ns) * 1e-9) /
                            setup_.servo.feature.radius;
  for (int i = 0; i < 3; ++i) {
    m.s[static_cast<std::size_t>(i)] = s[i] + normal(random_);
    m.cov_s[static_cast<std::size_t>(i * hal::kMaxFeatureDim + i)] = kNoise * kNoise;
  }
  if (setup_.spoil) {
    setup_.spoil(m);
  }
  under_way_.emplace_back(exposure.stamp_ns + kLatencyNs, m);
}

void GuardBench::HandOver(std::int64_t now_ns) {
  while (!under_way_.empty() && under_way_.front().first <= now_ns) {
    mailbox_.Put(under_way_.front().second);
    under_way_.pop_front();
  }
}

int GuardBench::FirstLimit(hal::Limit limit, int from_ms) const {
  const auto found = std::find_if(ticks_.begin(), ticks_.end(), [&](const GuardTick& tick) {
    return tick.ms >= from_ms && (tick.record.limits_active & hal::Bit(limit)) != 0;
  });
  return found == ticks_.end() ? -1 : found->ms;
}

int GuardBench::FirstFault() const {
  const auto found = std::find_if(ticks_.begin(), ticks_.end(), [](const GuardTick& tick) {
    return tick.record.mode == hal::Mode::kFault;
  });
  return found == ticks_.end() ? -1 : found->ms;
}

int GuardBench::AtRest() const {
  const auto moved = std::find_if(speeds_.rbegin(), speeds_.rend(), [](double s) { return s >= kAtRest; });
  return static_cast<int>(speeds_.rend() - moved);
}

std::function<moves::MotionCommand(const sim::Truth&, double)> Attack(
    double start_s, std::function<Eigen::Vector3d(const sim::Truth&)> velocity) {
  return [start_s, velocity = std::move(velocity)](const sim::Truth& truth, double t_s) {
    moves::MotionCommand command;
    if (t_s < start_s) {
      return command;
    }
    const Eigen::Vector3d v = velocity(truth);
    const Eigen::Vector3d p = truth.X_BE.translation() + kTickS * v;
    const Eigen::Quaterniond hand(truth.X_BE.linear());
    command.kind = moves::MotionKind::kPoseSetpoint;
    command.p_BE = {p.x(), p.y(), p.z()};
    command.quaternion_BE = {hand.w(), hand.x(), hand.y(), hand.z()};
    command.V_BE_B = {v.x(), v.y(), v.z(), 0.0, 0.0, 0.0};
    return command;
  };
}

std::function<moves::MotionCommand(const sim::Truth&, double)> GoTo(double start_s,
                                                                    const Eigen::VectorXd& q) {
  return [start_s, q](const sim::Truth&, double t_s) {
    moves::MotionCommand command;
    if (t_s >= start_s) {
      command.kind = moves::MotionKind::kJointGoal;
      std::copy(q.begin(), q.end(), command.q.begin());
    }
    return command;
  };
}

void ExpectInsideLimits(const GuardBench& bench, PushedBy by) {
  constexpr double kRounding = 1.0 + 1e-9;
  const GuardFigures& f = bench.figures();
  const config::SafetyConfig& safety = bench.config().safety;
  EXPECT_LE(f.torque, safety.torque_fraction * kRounding);
  EXPECT_LE(f.torque_rate, safety.torque_rate_fraction * kRounding);
  EXPECT_LE(f.acceleration, kRounding);
  EXPECT_LE(f.jerk, kRounding);
  if (by == PushedBy::kServo) {
    EXPECT_LE(f.position, 1.0);
    EXPECT_LE(f.velocity, 1.0);
    EXPECT_LE(f.radius, bench.config().guard.workspace_radius + 1e-3);
  }
}

void PrintFigures(const std::string& what, const GuardBench& bench) {
  const GuardFigures& f = bench.figures();
  std::cout << what << "; used: torque " << f.torque << ", its rate " << f.torque_rate << ", joint range "
            << f.position << ", velocity " << f.velocity << "; |p_BE| " << f.radius << " m, " << f.speed
            << " m/s\n";
}

}  // namespace fovea::test
