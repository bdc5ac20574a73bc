// SPDX-License-Identifier: Apache-2.0
// Whole runs of fovea-sim, with the servo on this computer or on the emulated board.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {

// The JSON summary of `fovea-sim run ARGUMENTS --servo SERVO`.
inline nlohmann::json RunSim(std::vector<std::string> arguments, const std::string& servo) {
  const TempFolder folder;
  arguments.insert(arguments.begin(), {FOVEA_SIM_PROGRAM, "run"});
  arguments.insert(arguments.end(),
                   {"--servo", servo, "--no-report", "--json", "--out", (folder.path() / "out").string()});
  const ProgramResult result = RunProgram(arguments, {}, std::chrono::seconds(600));
  EXPECT_NE(result.exit_code, 2) << result.err;
  return nlohmann::json::parse(result.out, nullptr, false);
}

}  // namespace fovea::test
