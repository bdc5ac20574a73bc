// SPDX-License-Identifier: Apache-2.0
// The command `fovea-sim serve`: its options, and what it does with them.
#pragma once

#include <string>
#include <vector>

#include "sim/app/serve.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace fovea::sim {

struct ServeArguments {
  std::string scenario;
  std::vector<std::string> assignments;
  int seed = -1;
  std::string pace = "real";
  bool json = false;
  std::vector<std::string> walls;
  bool live = false;
  live::ServerConfig page;  // used with `live`
  ServeOptions options;
};

// The arguments must outlive the parsing of `serve`.
void AddServe(CLI::App& serve, ServeArguments& arguments);
// Returns the program's exit code. InputError: wrong options or input.
int ServeCommand(const ServeArguments& arguments);

}  // namespace fovea::sim
