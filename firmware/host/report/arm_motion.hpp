// How camera and end effector moved, by the measured joints and the arm's model that the log holds.
#pragma once

#include <array>
#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/tick.pb.h"

namespace fovea::report {

class ArmMotion {
 public:
  // Without a model: nothing is known of any tick.
  ArmMotion() = default;
  // std::runtime_error when `message` is none of this program's.
  explicit ArmMotion(const log::ServoConfiguration& message);

  struct OfTick {
    std::array<float, 6> V_BC_C;  // the camera's twist, linear first [m/s, rad/s]
    float path_error_mm;          // from the end effector to where it is commanded to be in this tick
  };
  // NaN where nothing is known: without a model, without joints, or (path) without a commanded pose.
  [[nodiscard]] OfTick At(const log::Tick& tick) const;

 private:
  std::optional<config::ServoConfig> servo_;
};

}  // namespace fovea::report
