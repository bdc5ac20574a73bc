// SPDX-License-Identifier: Apache-2.0
// fovea atlas: the convergence rate of simulated runs from random starts; with --faults, the outcome of every
// fault in every mode and stage.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea {

struct AtlasArguments {
  std::string target;
  bool faults = false;
  bool markdown = false;
  std::vector<std::string> only;
  int runs = 1000;
  int jobs = 0;  // 0: one for every two cores
  std::optional<int> seed;
  std::vector<std::string> assignments;
  std::string out;
  bool resume = false;
  bool draw_only = false;
  bool json = false;
};

// Adds the subcommand, which fills `arguments`.
CLI::App* AddAtlas(CLI::App& app, AtlasArguments& arguments);

// Simulates the runs and prints the figures. Returns the program's exit code. Throws config::InputError.
int Atlas(const AtlasArguments& arguments);
// The same for --faults.
int FaultAtlas(const AtlasArguments& arguments);

// The number of runs in parallel.
int JobsOf(const AtlasArguments& arguments);

}  // namespace fovea
