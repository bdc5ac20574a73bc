// fovea replay: the recorded inputs of a log through the servo again.
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

// The subcommand, which fills `arguments`.
const CLI::App* AddReplay(CLI::App& app, ReplayArguments& arguments);

// Prints what came of it. The exit code: kDone, or kGoalMissed when something differs though nothing was set.
// Throws config::InputError.
int Replay(const ReplayArguments& arguments);

}  // namespace fovea
