// SPDX-License-Identifier: Apache-2.0
// Runs fovea-sim with a command line, in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {

class CommandLineTest : public testing::Test {
 protected:
  static ProgramResult Sim(std::vector<std::string> arguments,
                           const std::vector<std::string>& environment = {}) {
    arguments.insert(arguments.begin(), FOVEA_SIM_PROGRAM);
    return RunProgram(std::move(arguments), environment);
  }
  // The error of a refused run: one line, exit code 2, no files.
  std::string Refusal(std::vector<std::string> arguments) {
    const std::filesystem::path out = folder_.path() / "refused";
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--out", out.string()});
    const ProgramResult result = Sim(std::move(arguments));
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(out)) << "files were left behind";
    std::string line = result.err;
    line.erase(line.find_last_not_of('\n') + 1);
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    return line;
  }
  std::string Write(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_.path() / name;
    std::ofstream(path) << text;
    return path;
  }
  std::string Out() { return folder_.path() / "out"; }

  TempFolder folder_;
};

}  // namespace fovea::test
