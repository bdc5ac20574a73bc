// SPDX-License-Identifier: Apache-2.0
// The servo drives an arm that this program defines. Users with their own robot write such a program.
#include <Eigen/Cholesky>
#include <cstdio>

#include "fovea/hal/arm.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/linux_rt/record_ring.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "fovea/robot.hpp"
#include "fovea/servo_loop.hpp"

using namespace fovea;

// The driver: an arm that follows its own model. A real driver talks to its robot in DoRead and DoWrite.
class MyArm final : public hal::Arm {
 public:
  explicit MyArm(const model::ArmModel& model) : Arm(model.num_joints, /*paces_loop=*/false), model_(model) {
    state_.num_joints = model.num_joints;
    state_.q = model.q_ready;
  }

  void Move() {
    constexpr double kPeriodS = 1e-3;
    const int n = model_.num_joints;
    model::VecN q = model::ToVector(state_.q, n);
    model::VecN dq = model::ToVector(state_.dq, n);
    model::ArmPoses poses;
    model::ArmDynamics dynamics;
    model::ComputePoses(model_, q, poses);
    model::ComputeDynamics(model_, poses, dq, dynamics);
    const Eigen::VectorXd tau = model::ToVector(command_.tau_cmd, n) - dynamics.Cdq;
    dq += kPeriodS * Eigen::MatrixXd(dynamics.M).ldlt().solve(tau);
    q += kPeriodS * dq;
    state_.q = model::ToArray(q);
    state_.dq = model::ToArray(dq);
    state_.tau_applied = command_.tau_cmd;
    state_.stamp_ns += hal::kTickPeriodNs;
    ++state_.sequence;
  }

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    state = state_;
    return hal::Status::Ok();
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    command_ = command;
    return hal::Status::Ok();
  }

  model::ArmModel model_;
  hal::ArmState state_;
  hal::ArmCommand command_;
};

// Time advances only while the loop waits, and the arm moves with it.
class MyClock final : public hal::Clock {
 public:
  explicit MyClock(MyArm& arm) : arm_(arm) {}

 private:
  std::int64_t DoNowNs() const noexcept override { return now_ns_; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    arm_.Move();
    now_ns_ = deadline_ns;
    return hal::Status::Ok();
  }
  MyArm& arm_;
  std::int64_t now_ns_ = 0;
};

int main(int argc, char** argv) {
  if (argc != 2) {
    std::printf("usage: consumer ARM_FILE\n");
    return 2;
  }
  const robots::Robot robot = robots::LoadRobot(argv[1]);
  config::ServoConfig config;
  config.arm = robot.model;
  config.law.q_posture = robot.model.q_ready;
  config.feature.p_CO_C_star = {0.0, 0.0, 0.4};
  config.auto_track = true;
  task::ServoTask task;
  if (const hal::Status status = task.Init(config); !status.ok()) {
    std::printf("%s: %s\n", status.where(), hal::ToString(status.code()));
    return 2;
  }

  MyArm arm(robot.model);
  MyClock clock(arm);
  hal::FeatureMailbox mailbox;
  linux_rt::RecordRing records(8192);
  linux_rt::TickMeter meter;
  task::ServoLoop loop(task, arm, clock, mailbox, records, meter);
  // A camera that sees a ball at rest ten times a second. In a real program its vision task calls Put.
  const model::Vec3 p_BO(0.45, 0.10, 0.05);
  for (int frame = 0; frame < 60; ++frame) {
    if (!loop.Run(frame * hal::kNsPerSecond / 10).ok()) {
      return 1;
    }
    hal::FeatureMeasurement seen;
    seen.stamp_ns = clock.NowNs();
    seen.sequence = static_cast<std::uint64_t>(frame);
    seen.found = true;
    seen.confidence = 1.0;
    seen.dim = 3;
    const model::Vec3 s = (task.state().X_BC.Inverse() * p_BO) / config.feature.radius;
    for (std::size_t i = 0; i < 3; ++i) {
      seen.s[i] = s[static_cast<Eigen::Index>(i)];
      seen.cov_s[i * hal::kMaxFeatureDim + i] = 1e-6;
    }
    if (frame > 0) {  // frame 0 precedes the first tick
      mailbox.Put(seen);
    }
  }

  hal::TickRecord last;
  records.Drain([&](const hal::TickRecord& record) { last = record; });
  const double error = std::sqrt(last.e[0] * last.e[0] + last.e[1] * last.e[1] + last.e[2] * last.e[2]);
  std::printf("mode %s, error %.5f radii, %llu heap calls in the tick\n", hal::Name(last.mode), error,
              static_cast<unsigned long long>(meter.heap_calls()));
  return last.mode == hal::Mode::kTrack && error < 0.01 && meter.heap_calls() == 0 ? 0 : 1;
}
