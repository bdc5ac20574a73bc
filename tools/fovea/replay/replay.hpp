// SPDX-License-Identifier: Apache-2.0
// fovea replay: runs the servo on the recorded inputs of a log again.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fovea {

struct ReplayArguments {
  std::string log;
  double from_s = 0.0;
  std::vector<std::string> settings;
  std::string out;
  bool renew = false;
  bool json = false;
};

// Adds the subcommand, which fills `arguments`.
const CLI::App* AddReplay(CLI::App& app, ReplayArguments& arguments);

// Prints the result. Returns the exit code: kGoalMissed when something differs without --set, else kDone.
// Throws config::InputError.
int Replay(const ReplayArguments& arguments);

}  // namespace fovea
