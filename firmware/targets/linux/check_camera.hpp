// SPDX-License-Identifier: Apache-2.0
// Checks of the camera.
#pragma once

#include <vector>

#include "firmware/targets/linux/check.hpp"

namespace fovea::hw {

// Checks calibration and mounting, then rate, losses and latency of the pictures.
void CheckCamera(const HwConfig& config, std::vector<CheckRow>& rows);

}  // namespace fovea::hw
