// SPDX-License-Identifier: Apache-2.0
// The way to the goal with a reference that follows exactly, and plans made by hand.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "firmware/core/control/way_to_goal.hpp"
#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"
#include "tests/support/panda.hpp"

namespace fovea::control {

class PlannedWay : public testing::Test {
 protected:
  using Pose = model::Pose;
  using VecN = model::VecN;

  PlannedWay() : config_(test::PandaConfig()) {
    config_.feature.target = hal::FeatureKind::kTriangle;
    config_.feature.form = features::FeatureForm::kPose;
    config_.feature.corners = features::MakeTriangle(features::kDefaultTriangle);
    q_goal_ = test::Ready();
    q_goal_[0] += 0.9;
    q_goal_[4] -= 0.3;
    PutTargetFor(q_goal_);
    StandAt(test::Ready());
  }

  [[nodiscard]] Pose CameraAt(const VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    return poses.X_BE * config_.X_EC;
  }
  // So that the camera is at its goal with the joints at `q`.
  void PutTargetFor(const VecN& q) {
    X_BO_ = CameraAt(q) * Pose{config_.feature.R_CO_star, config_.feature.p_CO_C_star};
  }
  void StandAt(const VecN& q) {
    reference_.q = q;
    reference_.dq.setZero(q.size());
    reference_.ddq.setZero(q.size());
  }

  [[nodiscard]] WaySight Sight() const {
    return {.X_BO = X_BO_,
            .X_CO = CameraAt(reference_.q).Inverse() * X_BO_,
            .v_BO = v_BO_,
            .w_BO = w_BO_,
            .normal_B = normal_B_,
            .reference = reference_,
            .limits = limits_,
            .now_ns = now_ns_,
            .is_told_apart = told_apart_,
            .has_answer = false};
  }
  // One tick of the choice. Returns what happened to a plan.
  hal::PlanEvent Choose(bool has_answer = false) {
    now_ns_ += hal::kTickPeriodNs;
    WaySight sight = Sight();
    sight.has_answer = has_answer;
    sight.is_seen = is_seen_;
    sight.is_eye_trusted = is_eye_trusted_;
    ChooseWay(config_, sight, plan_, way_);
    if (way_.note.event != hal::PlanEvent::kNone) {
      events_.push_back(way_.note.event);
    }
    return way_.note.event;
  }
  void Choose(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      Choose();
    }
  }
  // Until `event`; the number of ticks, or -1 if it does not come.
  int TicksUntil(hal::PlanEvent event, int most = 5000) {
    for (int i = 1; i <= most; ++i) {
      if (Choose() == event) {
        return i;
      }
    }
    return -1;
  }

  // A motion from rest at `q` to rest at `q_end`, for the target where it is now.
  [[nodiscard]] trajectory::Plan PlanTo(const VecN& q, const VecN& q_end) const {
    constexpr int kPoints = 40;
    trajectory::Plan plan;
    plan.outcome = trajectory::PlanOutcome::kFound;
    plan.num_joints = static_cast<std::int32_t>(q.size());
    plan.num_points = kPoints;
    plan.period_s = 0.05;
    plan.stamp_ns = way_.asked_ns;
    for (int i = 0; i < kPoints; ++i) {
      const double share = trajectory::SmoothStep((i - 2.0) / (kPoints - 5.0));
      for (int j = 0; j < plan.num_joints; ++j) {
        plan.points[static_cast<std::size_t>(i * plan.num_joints + j)] = q[j] + share * (q_end[j] - q[j]);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      plan.p_BO[i] = X_BO_.p[static_cast<Eigen::Index>(i)];
    }
    plan.q_BO = model::QuaternionOf(X_BO_.R);
    return plan;
  }
  [[nodiscard]] trajectory::Plan PlanToGoal() const { return PlanTo(reference_.q, q_goal_); }
  hal::PlanEvent Answer(const trajectory::Plan& plan) {
    plan_ = plan;
    return Choose(true);
  }
  void AskForPlan() { ASSERT_GT(TicksUntil(hal::PlanEvent::kAsked), 0); }
  void BeginPlan() {
    AskForPlan();
    ASSERT_EQ(Answer(PlanToGoal()), hal::PlanEvent::kTaken);
    way_.trust = 1.0;  // full pace from the start
    ASSERT_EQ(way_.note.way, hal::Way::kPlan);
  }
  // One tick on the plan: the reference moves as wished, or stands if it is `held`.
  void Follow(bool held = false) {
    FollowPlan(config_, plan_, reference_, is_seen_, way_, step_);
    if (!held) {
      reference_.q += hal::kTickPeriodS * step_.task.v;
      reference_.dq = step_.task.v;
      reference_.ddq = step_.ddq;
    }
  }
  // To the plan's end, or away from it for another reason, which is returned.
  hal::PlanEvent FollowOn() {
    for (int i = 0; i < 20'000; ++i) {
      Follow();
      if (const hal::PlanEvent event = Choose(); event != hal::PlanEvent::kNone) {
        return event;
      }
    }
    return hal::PlanEvent::kNone;
  }
  void FollowFor(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      Follow();
      ASSERT_EQ(Choose(), hal::PlanEvent::kNone);
    }
  }

  config::ServoConfig config_;
  VecN q_goal_;
  Pose X_BO_;
  model::Vec3 v_BO_ = model::Vec3::Zero();
  model::Vec3 w_BO_ = model::Vec3::Zero();
  model::Vec3 normal_B_ = model::Vec3::Zero();
  trajectory::Reference reference_;
  hal::LimitSet limits_ = 0;
  std::int64_t now_ns_ = 1'000'000'000;
  bool told_apart_ = true;
  bool is_seen_ = true;
  bool is_eye_trusted_ = true;
  trajectory::Plan plan_;
  WayToGoal way_;
  PlanStep step_;
  std::vector<hal::PlanEvent> events_;
};

}  // namespace fovea::control
