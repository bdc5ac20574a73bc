// SPDX-License-Identifier: Apache-2.0
// An ideal arm, and a servo that moves it by commanded motions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "firmware/core/moves/follow_motion.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"

namespace fovea::moves {

using hal::Mode;

class FollowMotionTest : public testing::Test {
 protected:
  void SetUp() override { Start(test::PandaConfig(), test::Ready()); }

  void Start(config::ServoConfig config, const model::VecN& q) {
    config.auto_track = false;
    config_ = config;
    most_ = outermost_ = 0.0;
    ASSERT_TRUE(task_.Init(config).ok());
    arm_ = std::make_unique<test::IdealArm>(config.arm, q);
    outputs_ = {};
    for (int i = 0; i < 30; ++i) {
      Tick({});
    }
    ASSERT_EQ(record().mode, Mode::kHold);
  }

  const hal::TickRecord& Tick(const MotionCommand& command, task::Request request = task::Request::kNone) {
    task::ServoInputs inputs;
    inputs.arm = arm_->State();
    inputs.motion = command;
    inputs.request = request;
    const hal::TickRecord before = outputs_.record;
    task_.Step(inputs, outputs_);
    if (before.mode != Mode::kBoot) {
      NoteLimits(before, outputs_.record);
    }
    arm_->Apply(outputs_.command());
    arm_->Step();
    outermost_ = std::max(outermost_, PoseOf(arm_->q()).p.norm());
    return outputs_.record;
  }
  // Keeps the largest share of any limit that the reference uses.
  void NoteLimits(const hal::TickRecord& before, const hal::TickRecord& now) {
    for (int i = 0; i < config_.arm.num_joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const model::Joint& joint = config_.arm.joints[k];
      most_ =
          std::max({most_, std::fabs(now.dq_cmd[k]) / joint.dq_max, std::fabs(now.ddq_cmd[k]) / joint.ddq_max,
                    std::fabs(now.ddq_cmd[k] - before.ddq_cmd[k]) / (joint.dddq_max * 1e-3)});
    }
  }
  model::Pose PoseOf(const model::VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    return poses.X_BE;
  }
  model::VecN Reference() const { return model::ToVector(record().q_cmd, config_.arm.num_joints); }
  const hal::TickRecord& record() const { return outputs_.record; }

  static MotionCommand Joints(MotionKind kind, const model::VecN& q) {
    MotionCommand command;
    command.kind = kind;
    command.q = model::ToArray(q);
    return command;
  }
  static MotionCommand JointGoal(const model::VecN& q) { return Joints(MotionKind::kJointGoal, q); }
  static MotionCommand Pose(MotionKind kind, const model::Vec3& p, const model::Vec3& phi,
                            const model::Vec3& v = model::Vec3::Zero()) {
    MotionCommand command;
    command.kind = kind;
    const double angle = phi.norm();
    const double scale = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.0;
    command.quaternion_BE = {std::cos(0.5 * angle), scale * phi[0], scale * phi[1], scale * phi[2]};
    for (std::size_t i = 0; i < 3; ++i) {
      command.p_BE[i] = p[static_cast<Eigen::Index>(i)];
      command.V_BE_B[i] = v[static_cast<Eigen::Index>(i)];
    }
    return command;
  }
  // Runs until the motion ends. Returns the number of ticks.
  int RunToHold() {
    int ticks = 0;
    while (record().mode == Mode::kMove && ticks < 20000) {
      Tick({});
      ++ticks;
    }
    return ticks;
  }

  config::ServoConfig config_;
  task::ServoTask task_;
  task::ServoOutputs outputs_;
  std::unique_ptr<test::IdealArm> arm_;
  double most_ = 0.0;
  double outermost_ = 0.0;
};

}  // namespace fovea::moves
