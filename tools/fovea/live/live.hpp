// SPDX-License-Identifier: Apache-2.0
// fovea live: plays a log on the live page as if it came now.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fovea {

struct LiveArguments {
  std::string log;
  std::string address = "127.0.0.1";
  int port = 8765;
  std::vector<std::string> origins;
  double speed = 1.0;
};

// Adds the subcommand, which fills `arguments`.
const CLI::App* AddLive(CLI::App& app, LiveArguments& arguments);

// Plays until Ctrl-C or the page ends it. Returns the exit code. Throws config::InputError.
int Live(const LiveArguments& arguments);

}  // namespace fovea
