// SPDX-License-Identifier: Apache-2.0
// The keys of the end effector's load, the same for the simulator and for hardware.
#pragma once

#include <vector>

#include "firmware/core/model/load.hpp"
#include "firmware/host/config/key_table.hpp"

namespace fovea::config {

// The default is an industrial camera of 29 mm with its lens, behind the default mount.
struct LoadSettings {
  double mass = 0.25;                             // [kg]
  std::vector<double> com{0.05, 0.0, 0.02};       // in E [m]
  std::vector<double> inertia{2e-4, 2e-4, 1e-4};  // xx, yy, zz; optionally then xy, xz, yz [kg m^2]
};

// The settings must outlive the table.
void AddLoadKeys(LoadSettings& settings, KeyTable& keys);

// InputError: a wrong number of entries, or moments of inertia that no body can have.
model::Load MakeLoad(const LoadSettings& settings);

}  // namespace fovea::config
