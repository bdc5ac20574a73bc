// SPDX-License-Identifier: Apache-2.0
// The servo's inputs over some seconds, recorded with an ideal arm and a camera that measures the truth: one
// run per target, one of commanded motions, one of disturbances. For tests that watch the servo from outside.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/truth_eye.hpp"

namespace fovea::test {

struct ServoRun {
  std::string name;
  config::ServoConfig config;
  std::vector<task::ServoInputs> inputs;
};

inline config::ServoConfig ConfigOf(hal::FeatureKind target, features::FeatureForm form) {
  config::ServoConfig config = PandaConfig();
  config.feature.target = target;
  config.feature.form = form;
  if (target == hal::FeatureKind::kSquare) {
    config.feature.corners = features::MakeSquare(config.feature.side);
  } else if (target == hal::FeatureKind::kTriangle) {
    config.feature.corners = features::MakeTriangle(features::kDefaultTriangle);
  }
  if (config.feature.SeesOrientation()) {
    config.law.damping = 0.002;
  }
  return config;
}

// `change(tick, inputs)` may change each tick's inputs; `look(record)` sees what came of them.
template <class Change, class Look>
ServoRun RunOnIdealArm(const std::string& name, const config::ServoConfig& config, int ticks, bool sees,
                       const Change& change, const Look& look, double far = 1.0) {
  constexpr int kFrameTicks = 33;
  constexpr std::int64_t kLatencyNs = 40 * hal::kNsPerMs;
  ServoRun run{name, config, {}};
  model::VecN q = Ready();
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  const model::Pose X_BO =
      poses.X_BE * config.X_EC * model::Pose{config.feature.R_CO_star, config.feature.p_CO_C_star};
  const double off[] = {-0.30, -0.10, 0.05, -0.12, 0.10, 0.12, 0.25};
  for (int i = 0; i < 7; ++i) {
    q[i] += far * off[i];
  }
  IdealArm arm(config.arm, q);
  TruthEye eye(config.feature, 554.256, 0.05, 71);
  std::vector<hal::FeatureMeasurement> under_way;
  task::ServoTask task;
  EXPECT_TRUE(task.Init(config).ok());
  task::ServoOutputs outputs;
  run.inputs.reserve(static_cast<std::size_t>(ticks));
  for (int k = 0; k < ticks; ++k) {
    task::ServoInputs inputs;
    inputs.arm = arm.State();
    if (sees && k % kFrameTicks == 0) {
      model::ComputePoses(config.arm, arm.q(), poses);
      under_way.push_back(eye.See((poses.X_BE * config.X_EC).Inverse() * X_BO, inputs.arm.stamp_ns,
                                  static_cast<std::uint64_t>(k)));
    }
    if (!under_way.empty() && under_way.front().stamp_ns + kLatencyNs <= inputs.arm.stamp_ns) {
      inputs.has_feature = true;
      inputs.feature = under_way.front();
      under_way.erase(under_way.begin());
    }
    change(k, inputs);
    task.Step(inputs, outputs);
    look(outputs.record);
    arm.Apply(outputs.command());
    arm.Step();
    run.inputs.push_back(inputs);
  }
  return run;
}

template <class Change>
ServoRun RunOnIdealArm(const std::string& name, const config::ServoConfig& config, int ticks, bool sees,
                       const Change& change) {
  return RunOnIdealArm(name, config, ticks, sees, change, [](const hal::TickRecord&) {});
}

inline ServoRun TrackingRun(const std::string& name, hal::FeatureKind target, features::FeatureForm form,
                            int ticks) {
  return RunOnIdealArm(name, ConfigOf(target, form), ticks, true, [](int, task::ServoInputs&) {});
}

// Joint goals, pose goals, homing, a change of motion law, and a Hold request.
inline ServoRun CommandedRun(int ticks) {
  config::ServoConfig config = PandaConfig();
  config.auto_track = false;
  return RunOnIdealArm("commanded", config, ticks, false, [&config](int k, task::ServoInputs& inputs) {
    if (k > 50 && k < 700) {
      inputs.motion.kind = moves::MotionKind::kJointGoal;
      inputs.motion.q = config.arm.q_ready;
      inputs.motion.q[2] += k < 400 ? 0.2 : -0.1;
    } else if (k > 900 && k < 1800) {
      model::ArmPoses poses;
      model::ComputePoses(config.arm, Ready(), poses);
      inputs.motion.kind = moves::MotionKind::kPoseGoal;
      inputs.motion.p_BE = {poses.X_BE.p.x(), poses.X_BE.p.y() + 0.05, poses.X_BE.p.z()};
      inputs.motion.quaternion_BE = {0.0, 1.0, 0.0, 0.0};
    } else if (k >= 1800) {
      inputs.motion.kind = moves::MotionKind::kHome;
    }
    inputs.change_law = k == 600;
    inputs.law = config::MotionLawKind::kPd;
    if (k == 750) {
      inputs.request = task::Request::kHold;
    }
  });
}

// Missing states, NaN, missed ticks, a camera without measurements; at the end the arm is lost, then reset.
inline ServoRun TroubledRun(int ticks) {
  return RunOnIdealArm("troubled", ConfigOf(hal::FeatureKind::kSphere, features::FeatureForm::kSphere), ticks,
                       true, [ticks](int k, task::ServoInputs& inputs) {
                         if ((k > 300 && k < 310) || (k > ticks - 300 && k < ticks - 200)) {
                           inputs.arm_status = hal::Status(hal::StatusCode::kTimeout, "arm");
                         }
                         if (k > 500 && k < 503) {
                           inputs.arm.q[3] = std::nan("");
                         }
                         inputs.missed_ticks = k == 550 ? 3 : 0;
                         inputs.has_feature = inputs.has_feature && (k < 600 || k > 1500);
                         if (k == ticks - 150) {
                           inputs.request = task::Request::kReset;
                         }
                       });
}

// Keys that change while the arm tracks, and requests that are refused. Keys move at ticks 1000 and 2000.
inline ServoRun TunedRun(int ticks) {
  return RunOnIdealArm("tuned", ConfigOf(hal::FeatureKind::kSquare, features::FeatureForm::kCorners), ticks,
                       true, [](int k, task::ServoInputs& inputs) {
                         switch (k) {
                           case 450: inputs.tuning = {0, 4.0}; break;   // servo.lambda
                           case 560: inputs.tuning = {0, 1.0}; break;   // before it is there
                           case 700: inputs.tuning = {4, 40.0}; break;  // out of range
                           case 900: inputs.tuning = {1, 3.0}; break;   // servo.lambda_near, from 0
                           case 950: inputs.tuning = {8, 5.0}; break;   // servo.target_jerk
                           case 1400: inputs.tuning = {0, std::nan("")}; break;
                           case 1500: inputs.tuning = {14, 1.0}; break;   // no key
                           case 1600: inputs.tuning = {11, 10.0}; break;  // above servo.coast_s
                           case 1900: inputs.tuning = {0, 2.5}; break;
                           case 1950: inputs.tuning = {1, 0.0}; break;
                           case 1999: inputs.tuning = {3, 0.01}; break;  // servo.damping
                           case 2300: inputs.tuning = {4, 0.0}; break;   // servo.posture_gain
                           default: break;
                         }
                       });
}

// A ball to whose place plans lead: the first one is interrupted by a Hold request, the second one is for
// another target.
inline ServoRun PlannedRun(int ticks) {
  trajectory::PlanSender sender;
  const config::ServoConfig config = ConfigOf(hal::FeatureKind::kSphere, features::FeatureForm::kSphere);
  return RunOnIdealArm(
      "planned", config, ticks, true,
      [&sender](int k, task::ServoInputs& inputs) {
        inputs.plan = sender.Next();
        inputs.request = k == 1000   ? task::Request::kHold
                         : k == 1300 ? task::Request::kTrack
                                     : task::Request::kNone;
      },
      [&](const hal::TickRecord& record) {
        if (record.way.event != hal::PlanEvent::kAsked) {
          return;
        }
        trajectory::Plan plan;
        plan.outcome = trajectory::PlanOutcome::kFound;
        plan.num_joints = config.arm.num_joints;
        plan.num_points = 60;
        plan.period_s = 0.05;
        plan.stamp_ns = record.stamp_ns;
        plan.p_BO = record.p_BO;
        plan.p_BO[0] += record.way.plans_asked == 2 ? 0.5 : 0.0;
        const model::VecN q_asked = model::ToVector(record.q_cmd, plan.num_joints);
        for (int i = 0; i < plan.num_points; ++i) {
          const double share = trajectory::SmoothStep((i - 2.0) / (plan.num_points - 5.0));
          for (int j = 0; j < plan.num_joints; ++j) {
            plan.points[static_cast<std::size_t>(i * plan.num_joints + j)] =
                q_asked[j] + share * (Ready()[j] - q_asked[j]);
          }
        }
        sender.Begin(plan);
      },
      /*far=*/2.5);  // so far that a plan is asked for
}

// A predictive law. Each horizon leads on from the reference and ends at rest where a motion at its speed
// would be after 0.25 s. None comes for a while.
inline ServoRun PredictiveRun(int ticks) {
  trajectory::PlanSender sender;
  config::ServoConfig config = ConfigOf(hal::FeatureKind::kSphere, features::FeatureForm::kSphere);
  config.law.law = config::Law::kPredictive;
  std::int32_t asked = 0;
  return RunOnIdealArm(
      "predictive", config, ticks, true,
      [&sender](int k, task::ServoInputs& inputs) {
        inputs.plan = k < 1200 || k > 1700 ? sender.Next() : trajectory::PlanPart{};
      },
      [&, config](const hal::TickRecord& record) {
        if (record.way.plans_asked == asked) {
          return;
        }
        asked = record.way.plans_asked;
        constexpr double kPeriod = 0.1;
        trajectory::Plan plan;
        plan.outcome = trajectory::PlanOutcome::kFound;
        plan.num_joints = config.arm.num_joints;
        plan.num_points = 10;
        plan.period_s = kPeriod;
        plan.stamp_ns = record.stamp_ns;
        plan.p_BO = record.p_BO;
        plan.q_BO = record.q_BO;
        for (int i = 0; i < plan.num_points; ++i) {
          for (int j = 0; j < plan.num_joints; ++j) {
            const auto k = static_cast<std::size_t>(j);
            const double knots = std::min(i - 1.0, 2.5);
            plan.points[static_cast<std::size_t>(i * plan.num_joints + j)] =
                record.q_cmd[k] + knots * kPeriod * record.dq_cmd[k] + 1e-3 * (Ready()[j] - record.q_cmd[k]);
          }
        }
        sender.Begin(plan);
      });
}

// All runs. Each lasts 2600 ticks, past the keyframes of ticks 1000 and 2000.
inline std::vector<ServoRun> AllServoRuns() {
  using features::FeatureForm;
  using hal::FeatureKind;
  std::vector<ServoRun> runs;
  runs.push_back(TrackingRun("sphere", FeatureKind::kSphere, FeatureForm::kSphere, 2600));
  runs.push_back(TrackingRun("circle", FeatureKind::kCircle, FeatureForm::kCircle, 2600));
  runs.push_back(TrackingRun("square", FeatureKind::kSquare, FeatureForm::kCorners, 2600));
  runs.push_back(TrackingRun("triangle", FeatureKind::kTriangle, FeatureForm::kPose, 2600));
  runs.push_back(CommandedRun(2600));
  runs.push_back(TroubledRun(2600));
  runs.push_back(TunedRun(2600));
  runs.push_back(PlannedRun(2600));
  runs.push_back(PredictiveRun(2600));
  return runs;
}

}  // namespace fovea::test
