// SPDX-License-Identifier: Apache-2.0
// The links' poses at a posture, computed when they are first asked for.
#pragma once

#include <optional>

#include "firmware/core/model/kinematics.hpp"

namespace fovea::model {

class LazyPoses {
 public:
  // `arm` and `q` [num_joints] must outlive the object and stay as they are.
  LazyPoses(const ArmModel& arm, const VecN& q) noexcept : arm_(arm), q_(q) {}

  [[nodiscard]] const VecN& q() const noexcept { return q_; }

  // Real-time: yes.
  [[nodiscard]] const ArmPoses& Get() noexcept {
    if (!poses_) {
      ComputePoses(arm_, q_, poses_.emplace());
    }
    return *poses_;
  }

 private:
  const ArmModel& arm_;
  const VecN& q_;
  std::optional<ArmPoses> poses_;
};

}  // namespace fovea::model
