// SPDX-License-Identifier: Apache-2.0
// An arm that obeys its model, M ddq + C dq = tau, and a camera that measures without error. The benchmarks
// close the servo's loop with them.
#pragma once

#include "firmware/core/task/servo_task.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::bench {

inline constexpr int kLatencyTicks = 40;  // from exposure to the servo
inline constexpr int kFrameTicks = 33;    // from one exposure to the next

// Real-time: yes.
class ModelArm {
 public:
  ModelArm(const model::ArmModel& arm, const model::VecN& q)
      : arm_(arm), q_(q), dq_(model::VecN::Zero(q.size())), tau_(model::VecN::Zero(q.size())) {}

  // Advances the arm by 1 ms under `command`.
  void Tick(const hal::ArmCommand& command) noexcept;

  [[nodiscard]] hal::ArmState State() const noexcept;
  [[nodiscard]] const model::VecN& q() const noexcept { return q_; }

 private:
  model::ArmModel arm_;
  model::VecN q_;
  model::VecN dq_;
  model::VecN tau_;
  std::uint64_t tick_ = 0;
};

// A servo for `arm` with the default camera mount. It tracks the target that it sees.
config::ServoConfig DefaultConfig(const model::ArmModel& arm);

// X_BC, the pose of the camera in B.
model::Pose CameraAt(const config::ServoConfig& config, const model::VecN& q);

// The camera's measurement of a ball at `p_BO` [m] in B. Real-time: yes.
hal::FeatureMeasurement Measure(const config::ServoConfig& config, const ModelArm& arm,
                                const model::Vec3& p_BO);

}  // namespace fovea::bench
