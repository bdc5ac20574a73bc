// SPDX-License-Identifier: Apache-2.0
// The task in closed loop with an ideal arm and a camera that measures without error.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "firmware/core/task/servo_task.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"

namespace fovea::task {

inline constexpr int kLatencyMs = 40;
inline constexpr int kFrameMs = 33;

// A task, an ideal arm, and a camera that measures without error, 40 ms late.
class ServoTaskTest : public testing::Test {
 protected:
  void Start(const config::ServoConfig& config) {
    config_ = config;
    config_.law.plans = plans_;
    ASSERT_TRUE(task_.Init(config_).ok());
    model::VecN q = test::Ready();
    q[0] -= 0.3;
    arm_ = std::make_unique<test::IdealArm>(config.arm, q);
    target_ = X_BC() * model::Vec3(-0.10, 0.08, 0.55);
  }
  void SetUp() override { Start(test::PandaConfig()); }

  model::Pose X_BC() const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, arm_->q(), poses);
    return poses.X_BE * config_.X_EC;
  }

  // Runs one tick; `change` may change the inputs.
  const hal::TickRecord& Tick(const std::function<void(ServoInputs&)>& change = {}) {
    ServoInputs inputs;
    inputs.arm = arm_->State();
    if (camera_on_ && ticks_ >= kLatencyMs && (ticks_ - kLatencyMs) % kFrameMs == 0) {
      inputs.has_feature = true;
      inputs.feature = pending_.at(static_cast<std::size_t>(ticks_ - kLatencyMs));
    }
    pending_.push_back(Measure());
    if (change) {
      change(inputs);
    }
    task_.Step(inputs, outputs_);
    arm_->Apply(outputs_.command());
    arm_->Step();
    ++ticks_;
    return outputs_.record;
  }
  const hal::TickRecord& Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      Tick();
    }
    return outputs_.record;
  }

  hal::FeatureMeasurement Measure() const {
    hal::FeatureMeasurement m;
    m.stamp_ns = arm_->State().stamp_ns;
    m.sequence = static_cast<std::uint64_t>(ticks_);
    m.found = true;
    m.confidence = 1.0;
    m.dim = 3;
    const model::Vec3 s = (X_BC().Inverse() * target_) / config_.feature.radius;
    for (int i = 0; i < 3; ++i) {
      m.s[static_cast<std::size_t>(i)] = s[i];
      m.cov_s[static_cast<std::size_t>(i * hal::kMaxFeatureDim + i)] = 1e-6;
    }
    return m;
  }
  double Error() const { return (X_BC().Inverse() * target_ - config_.feature.p_CO_C_star).norm(); }

  config::ServoConfig config_;
  ServoTask task_;
  ServoOutputs outputs_;
  std::unique_ptr<test::IdealArm> arm_;
  model::Vec3 target_;
  bool camera_on_ = true;
  bool plans_ = false;  // the law alone
  int ticks_ = 0;
  std::vector<hal::FeatureMeasurement> pending_;
};

}  // namespace fovea::task
