// SPDX-License-Identifier: Apache-2.0
// fovea compare: plays a log's commands into the simulator's arm.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fovea {

struct CompareArguments {
  std::string log;
  std::string scenario;
  std::vector<std::string> settings;
  int window_ms = 100;
  std::string out;
  bool json = false;
};

// Adds the subcommand, which fills `arguments`. Null in a build without the simulator.
const CLI::App* AddCompare(CLI::App& app, CompareArguments& arguments);

// Prints the result. Returns the exit code kDone. config::InputError: the log cannot be compared.
int Compare(const CompareArguments& arguments);

}  // namespace fovea
