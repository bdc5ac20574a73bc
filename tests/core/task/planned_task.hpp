// SPDX-License-Identifier: Apache-2.0
// The task with plans made by hand: they arrive in parts, as from the planner's line.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/core/model/rotation.hpp"
#include "firmware/core/trajectory/plan_part.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"
#include "tests/core/task/task_on_ideal_arm.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::task {

// The largest share used of each limit by the references of records in a row.
class ReferenceWatch {
 public:
  explicit ReferenceWatch(const config::ServoConfig& config) : config_(config) {}

  void Look(const hal::TickRecord& record) {
    const int n = config_.arm.num_joints;
    const model::VecN q = model::ToVector(record.q_cmd, n);
    const model::VecN dq = model::ToVector(record.dq_cmd, n);
    const model::VecN ddq = model::ToVector(record.ddq_cmd, n);
    ASSERT_TRUE(q.allFinite() && dq.allFinite() && ddq.allFinite());
    for (int i = 0; i < n; ++i) {
      const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
      const double half = 0.5 * (joint.q_max - joint.q_min) - config_.guard.joint_position_margin;
      Use(position, std::fabs(q[i] - 0.5 * (joint.q_max + joint.q_min)) / half);
      Use(velocity, std::fabs(dq[i]) / (config_.guard.joint_velocity_fraction * joint.dq_max));
      Use(acceleration, std::fabs(ddq[i]) / (config_.guard.joint_acceleration_fraction * joint.ddq_max));
      if (has_last_) {
        Use(jerk, std::fabs(ddq[i] - ddq_[i]) /
                      (config_.guard.joint_jerk_fraction * joint.dddq_max * hal::kTickPeriodS));
        EXPECT_NEAR(q[i] - q_[i], dq[i] * hal::kTickPeriodS, 1e-12);
      }
    }
    model::ArmPoses poses;
    model::LinearJacobian J;
    model::ComputePoses(config_.arm, q, poses);
    model::ComputeLinearJacobian(config_.arm, poses, poses.X_BE.p, J);
    Use(speed, J.lazyProduct(dq).norm() / config_.guard.cartesian_speed);
    Use(turn, model::AngularVelocity(config_.arm, poses, dq).norm() / config_.guard.rotation_speed);
    Use(radius, poses.X_BE.p.norm() - config_.guard.workspace_radius);
    q_ = q;
    ddq_ = ddq;
    has_last_ = true;
  }
  // As tests/core/guard has it for wishes of every kind.
  void ExpectAllHeld() const {
    EXPECT_LE(position, 1.0 + 1e-3);
    EXPECT_LE(velocity, 1.0 + 0.01);
    EXPECT_LE(acceleration, 1.0 + 1e-9);
    EXPECT_LE(jerk, 1.0 + 1e-9);
    EXPECT_LE(speed, 1.0 + 1e-3);
    EXPECT_LE(turn, 1.0 + 1e-3);
    EXPECT_LE(radius, 1e-3);
  }

  double position = 0.0, velocity = 0.0, acceleration = 0.0, jerk = 0.0, speed = 0.0, turn = 0.0;
  double radius = -HUGE_VAL;  // past the workspace [m]

 private:
  static void Use(double& most, double now) { most = std::max(most, now); }

  config::ServoConfig config_;
  model::VecN q_;
  model::VecN ddq_;
  bool has_last_ = false;
};

class PlannedTask : public ServoTaskTest {
 protected:
  // The target is so far away that a plan is asked for.
  void StartFar() {
    plans_ = true;
    Start(test::PandaConfig());
    target_ = X_BC() * model::Vec3(-0.10, 0.08, 0.55);
  }
  void SetUp() override { StartFar(); }

  // Runs until `event`, or for `most` ticks. True if it came.
  bool RunUntil(hal::PlanEvent event, int most = 4000) {
    for (int i = 0; i < most; ++i) {
      if (Tick().way.event == event) {
        return true;
      }
    }
    return false;
  }

  // A posture in which the camera is at its goal before the target.
  [[nodiscard]] model::VecN Goal(model::VecN q) const {
    for (int i = 0; i < 200; ++i) {
      model::ArmPoses poses;
      model::ComputePoses(config_.arm, q, poses);
      const model::Pose X_BC = poses.X_BE * config_.X_EC;
      model::Mat6N J;
      model::ComputeJacobian(config_.arm, poses, config_.X_EC, J);
      const model::Vec3 p_CO = X_BC.Inverse() * target_;
      // The target moves in C against the camera: dp = -v - w x p.
      Eigen::Matrix<double, 3, Eigen::Dynamic> by_joint = -J.topRows<3>();
      for (int j = 0; j < config_.arm.num_joints; ++j) {
        by_joint.col(j) -= model::Vec3(J.col(j).tail<3>()).cross(p_CO);
      }
      const model::Vec3 off = config_.feature.p_CO_C_star - p_CO;
      const model::Mat3 A = by_joint * by_joint.transpose() + 1e-4 * model::Mat3::Identity();
      q += 0.5 * by_joint.transpose() * A.ldlt().solve(off);
    }
    return q;
  }

  // The answer to the request of the last record, with a motion to `q_end`.
  [[nodiscard]] trajectory::Plan PlanTo(const model::VecN& q_end, int points = 60,
                                        double period_s = 0.04) const {
    const hal::TickRecord& asked = outputs_.record;
    trajectory::Plan plan;
    plan.outcome = trajectory::PlanOutcome::kFound;
    plan.num_joints = config_.arm.num_joints;
    plan.num_points = points;
    plan.period_s = period_s;
    plan.stamp_ns = asked.stamp_ns;
    plan.p_BO = asked.p_BO;
    plan.q_BO = asked.q_BO;
    const model::VecN q = model::ToVector(asked.q_cmd, plan.num_joints);
    for (int i = 0; i < points; ++i) {
      const double share = trajectory::SmoothStep((i - 2.0) / (points - 5.0));
      for (int j = 0; j < plan.num_joints; ++j) {
        plan.points[static_cast<std::size_t>(i * plan.num_joints + j)] = q[j] + share * (q_end[j] - q[j]);
      }
    }
    return plan;
  }
  [[nodiscard]] trajectory::Plan PlanToGoal(double period_s = 0.04) const {
    return PlanTo(Goal(model::ToVector(outputs_.record.q_cmd, config_.arm.num_joints)), 60, period_s);
  }
  // Sends all parts of `plan`, one in a tick.
  const hal::TickRecord& Send(const trajectory::Plan& plan) {
    trajectory::PlanSender sender;
    sender.Begin(plan);
    while (!sender.IsDone()) {
      Tick([&sender](ServoInputs& inputs) { inputs.plan = sender.Next(); });
    }
    return outputs_.record;
  }
  // A slow motion: it is still far from the goal after a second.
  void BeginPlan() {
    ASSERT_TRUE(RunUntil(hal::PlanEvent::kAsked));
    ASSERT_EQ(Send(PlanToGoal(0.08)).way.event, hal::PlanEvent::kTaken);
  }
};

}  // namespace fovea::task
