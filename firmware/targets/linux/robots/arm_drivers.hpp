// SPDX-License-Identifier: Apache-2.0
// The robots' drivers by their names in robot.driver: a closed list.
#pragma once

#include <memory>
#include <span>
#include <tuple>

#include "firmware/targets/linux/robots/arm_driver.hpp"
#include "firmware/targets/linux/robots/fci/fci_driver.hpp"

namespace fovea::hw {

template <class... Drivers>
struct DriverList {
  using Settings = std::tuple<typename Drivers::Settings...>;
};

using ArmDriverList = DriverList<  // the first is the one that is not named
    FciDriver>;

// Of each driver; only those of the chosen one have keys.
using ArmDriverSettings = ArmDriverList::Settings;

struct ArmDriverEntry {
  const char* name;
  const char* meaning;
  int num_joints;
  void (*add_keys)(HwConfig& config, config::KeyTable& keys);
  void (*check_settings)(const HwConfig& config);
  std::unique_ptr<ArmDriver> (*make)(const HwConfig& config);
};
std::span<const ArmDriverEntry> ArmDrivers();

// The entry that config.robot.driver names; it must be in the list.
const ArmDriverEntry& ArmDriverOf(const HwConfig& config);

}  // namespace fovea::hw
