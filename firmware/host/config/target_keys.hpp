// SPDX-License-Identifier: Apache-2.0
// The keys of section [target] that describe the target, the same for the simulator and for hardware.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/host/config/key_table.hpp"

namespace fovea::config {

struct TargetSettings {
  std::string kind = "sphere";
  double diameter = 0.080;  // of sphere and circle [m]
  double side = 0.10;       // of the square [m]
  // The triangle's corners, x and y of each [m].
  std::vector<double> triangle{features::kDefaultTriangle.begin(), features::kDefaultTriangle.end()};
};

// The settings must outlive the table.
void AddTargetKeys(TargetSettings& settings, KeyTable& keys);

// The target without a goal, with the default feature of its kind. InputError: a degenerate triangle, or one
// so nearly equilateral, isosceles or flat that its corners cannot be told apart.
features::TargetFeature MakeTarget(const TargetSettings& settings);

}  // namespace fovea::config
