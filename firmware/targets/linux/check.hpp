// SPDX-License-Identifier: Apache-2.0
// The pre-flight check of computer, robot and camera before an arm moves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/host/config/terminal.hpp"
#include "firmware/targets/linux/hw_config.hpp"

namespace fovea::hw {

enum class Verdict : std::uint8_t { kPass, kWarn, kFail };

struct CheckRow {
  std::string what;
  Verdict verdict = Verdict::kPass;
  std::string found;
  std::string advice;  // what to do; empty when there is nothing
};

// Checks the computer, the robot (without moving it) and the camera. Never throws NetworkError or
// CameraError: a missing device is a row.
std::vector<CheckRow> Check(const HwConfig& config);

[[nodiscard]] bool AnyFails(const std::vector<CheckRow>& rows);
std::string ToTable(const std::vector<CheckRow>& rows, const config::TextStyle& style = {});
std::string ToJson(const std::vector<CheckRow>& rows);

}  // namespace fovea::hw
