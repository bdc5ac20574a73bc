// The hand, with the camera and the tools on it, stays out of a plane or a box.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// Before plane or box `obstacle`, planes first: the distance of the hand's nearest point or ball [m]. The
// guard proves a stop before each; the row keeps it from having to. Real-time: yes.
[[nodiscard]] Barrier HandBarrier(const config::ServoConfig& config, int obstacle,
                                  const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
