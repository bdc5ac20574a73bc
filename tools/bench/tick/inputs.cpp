// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/inputs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "firmware/core/trajectory/plan_line.hpp"
#include "firmware/planning/plan_desk.hpp"
#include "tools/bench/tick/model_arm.hpp"

namespace fovea::bench {
namespace {

constexpr double kTickS = 1e-3;

struct Loop {
  model::VecN q_start;
  model::Vec3 p_BO;  // position of the target in B [m]
  int ticks = 4000;
  int unseen_from = 4000;                                   // from this tick on the camera sees no target
  int silent_from = 4000;                                   // from this tick on the arm sends no state
  std::function<moves::MotionCommand(double t_s)> command;  // empty: no command, and the camera is on
};

// Closes the loop and records the servo's inputs in `run`.
void Fill(const Loop& loop, TickCase& run) {
  task::ServoTask task;
  if (!task.Init(run.config).ok()) {
    run.inputs.clear();
    return;
  }
  ModelArm arm(run.config.arm, loop.q_start);
  std::vector<hal::FeatureMeasurement> seen;
  task::ServoOutputs outputs;
  planning::PlanDesk planner(run.config);
  trajectory::PlanLine plans;
  plans.Use(&planner.box());
  run.inputs.reserve(static_cast<std::size_t>(loop.ticks));
  for (int k = 0; k < loop.ticks; ++k) {
    task::ServoInputs inputs;
    if (k < loop.silent_from) {
      inputs.arm = arm.State();
    } else {
      inputs.arm_status = hal::Status(hal::StatusCode::kTimeout, "arm");
    }
    seen.push_back(Measure(run.config, arm, loop.p_BO));
    const bool sees = !loop.command && k < loop.unseen_from;
    if (sees && k >= kLatencyTicks && (k - kLatencyTicks) % kFrameTicks == 0) {
      inputs.has_feature = true;
      inputs.feature = seen[static_cast<std::size_t>(k - kLatencyTicks)];
    }
    if (loop.command) {
      inputs.motion = loop.command(kTickS * k);
    }
    planner.Act(k * hal::kTickPeriodNs);
    inputs.plan = plans.Next();
    task.Step(inputs, outputs);
    plans.Note(outputs.record);
    arm.Tick(outputs.command());
    run.inputs.push_back(inputs);
  }
}

}  // namespace

namespace {

Loop TrackingLoop(const config::ServoConfig& config) {
  Loop loop;
  loop.q_start = model::ToVector(config.arm.q_ready, config.arm.num_joints);
  loop.q_start[0] -= 0.3;
  loop.p_BO = CameraAt(config, loop.q_start) * model::Vec3(-0.10, 0.08, 0.55);
  return loop;
}

}  // namespace

TickCase TrackingCase(const model::ArmModel& arm) {
  TickCase run{"tracking", DefaultConfig(arm), {}};
  Fill(TrackingLoop(run.config), run);
  return run;
}

TickCase LossCase(const model::ArmModel& arm) {
  TickCase run{"loss", DefaultConfig(arm), {}};
  Loop loop = TrackingLoop(run.config);
  loop.ticks = 2500;
  loop.unseen_from = 1000;
  loop.silent_from = 2200;
  Fill(loop, run);
  return run;
}

TickCase CommandedCase(const model::ArmModel& arm) {
  TickCase run{"commanded", DefaultConfig(arm), {}};
  run.config.auto_track = false;
  Loop loop = TrackingLoop(run.config);
  loop.q_start = model::ToVector(arm.q_ready, arm.num_joints);
  model::ArmPoses poses;
  model::ComputePoses(arm, loop.q_start, poses);
  const Eigen::Quaterniond hand(poses.X_BE.R);
  loop.command = [p = poses.X_BE.p, hand](double t_s) {
    constexpr double kRadius = 0.12;  // [m]
    constexpr double kOmega = std::numbers::pi;
    constexpr double kBegin = 0.1;  // after Boot [s]
    moves::MotionCommand command;
    if (t_s < kBegin) {
      return command;
    }
    command.kind = moves::MotionKind::kPoseSetpoint;
    // The circle grows from nothing, r(t) = R (1 - exp(-t)), so that the motion begins at rest.
    const double t = t_s - kBegin;
    const double r = kRadius * (1.0 - std::exp(-t));
    const double dr = kRadius * std::exp(-t);
    const double s = std::sin(kOmega * t);
    const double c = std::cos(kOmega * t);
    command.p_BE = {p.x(), p.y() + r * s, p.z() + r * (1.0 - c)};
    command.V_BE_B = {0.0, dr * s + r * kOmega * c, dr * (1.0 - c) + r * kOmega * s, 0.0, 0.0, 0.0};
    command.quaternion_BE = {hand.w(), hand.x(), hand.y(), hand.z()};
    return command;
  };
  Fill(loop, run);
  return run;
}

TickCase RandomCase(const model::ArmModel& arm, unsigned seed) {
  std::mt19937_64 engine(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  TickCase run{"random", DefaultConfig(arm), {}};
  run.config.law.joint_limit_gain = 0.2;
  run.config.law.manipulability_gain = 0.2;
  config::Obstacles& obstacles = run.config.guard.obstacles;
  obstacles.num_planes = 1;
  obstacles.planes[0] = {{0.0, 0.0, 1.0}, 0.02};
  obstacles.num_boxes = 2;
  for (int i = 0; i < obstacles.num_boxes; ++i) {
    const model::Vec3 low(uniform(0.3, 0.7), uniform(-0.5, 0.4), uniform(0.0, 0.5));
    obstacles.boxes[static_cast<std::size_t>(i)] = {low, low + model::Vec3(0.15, 0.15, 0.15)};
  }
  model::VecN q = model::ToVector(arm.q_ready, arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    q[i] = std::clamp(q[i] + uniform(-0.7, 0.7), joint.q_min + 0.1, joint.q_max - 0.1);
  }
  run.config.feature.p_CO_C_star.z() = uniform(0.2, 0.8);
  Loop loop;
  loop.q_start = q;
  loop.ticks = 1500;
  const model::Vec3 p_CO_C(uniform(-0.25, 0.25), uniform(-0.2, 0.2), uniform(0.3, 1.0));
  loop.p_BO = CameraAt(run.config, q) * p_CO_C;
  Fill(loop, run);
  return run;
}

}  // namespace fovea::bench
