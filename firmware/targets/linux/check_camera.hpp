// What of the camera is as it should be.
#pragma once

#include <vector>

#include "firmware/targets/linux/check.hpp"

namespace fovea::hw {

// Calibration and mounting; then rate, losses, and how old pictures are when they come.
void CheckCamera(const HwConfig& config, std::vector<CheckRow>& rows);

}  // namespace fovea::hw
