// SPDX-License-Identifier: Apache-2.0
// The keys of section [vision], the same for the simulator and for hardware.
#pragma once

#include <string>

#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/target_keys.hpp"
#include "firmware/vision/detector_config.hpp"

namespace fovea::config {

// The values of the keys, before camera and target are known.
struct VisionSettings {
  vision::DetectorConfig config;
  std::string method = "colour";
};

// The settings must outlive the table.
void AddVisionKeys(VisionSettings& settings, KeyTable& keys);

// The detector's whole configuration. InputError: empty ranges, or a method that cannot find this target.
vision::DetectorConfig MakeVisionConfig(const VisionSettings& settings, const vision::Intrinsics& intrinsics,
                                        const TargetSettings& target);

}  // namespace fovea::config
