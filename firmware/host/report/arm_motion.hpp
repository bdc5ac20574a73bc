// SPDX-License-Identifier: Apache-2.0
// Motion of camera and end effector, computed from the measured joints and the arm's model in the log.
#pragma once

#include <array>
#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/tick.pb.h"

namespace fovea::report {

class ArmMotion {
 public:
  // Without a model: At returns NaN for every tick.
  ArmMotion() = default;
  // std::runtime_error when `message` does not fit this program.
  explicit ArmMotion(const log::ServoConfiguration& message);

  struct OfTick {
    std::array<float, 6> V_BC_C;  // the camera's twist, linear first [m/s, rad/s]
    float path_error_mm;          // from the end effector to its commanded position in this tick
  };
  // NaN for unknown values: without a model, without joints, or (path) without a commanded pose.
  [[nodiscard]] OfTick At(const log::Tick& tick) const;

 private:
  std::optional<config::ServoConfig> servo_;
};

}  // namespace fovea::report
