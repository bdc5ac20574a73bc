// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/robots/arm_drivers.hpp"

#include <algorithm>
#include <array>

#include "firmware/targets/linux/hw_config.hpp"

namespace fovea::hw {
namespace {

template <class Driver>
constexpr ArmDriverEntry EntryOf() {
  return {
      Driver::kName,
      Driver::kMeaning,
      Driver::kJoints,
      [](HwConfig& config, config::KeyTable& keys) {
        Driver::AddKeys(std::get<typename Driver::Settings>(config.robot.of_driver), keys);
      },
      [](const HwConfig& config) { Driver::CheckSettings(config); },
      [](const HwConfig& config) -> std::unique_ptr<ArmDriver> { return std::make_unique<Driver>(config); }};
}

template <class... Drivers>
constexpr std::array<ArmDriverEntry, sizeof...(Drivers)> EntriesOf(DriverList<Drivers...> /*list*/) {
  return {EntryOf<Drivers>()...};
}

constexpr std::array kEntries = EntriesOf(ArmDriverList{});

}  // namespace

std::span<const ArmDriverEntry> ArmDrivers() { return kEntries; }

const ArmDriverEntry& ArmDriverOf(const HwConfig& config) {
  return *std::find_if(kEntries.begin(), kEntries.end(),
                       [&config](const ArmDriverEntry& entry) { return config.robot.driver == entry.name; });
}

}  // namespace fovea::hw
