// SPDX-License-Identifier: Apache-2.0
// Keeps the hand, with its camera and tools, out of a plane or a box.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// h is the distance of the hand's nearest point or ball from plane or box `obstacle` (planes first) [m]. The
// guard proves a stop before each obstacle. The row keeps more distance, so that the guard need not
// interfere. Real-time: yes.
[[nodiscard]] Barrier HandBarrier(const config::ServoConfig& config, int obstacle,
                                  const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
