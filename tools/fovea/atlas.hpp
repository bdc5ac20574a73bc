// fovea atlas: many simulated runs from random starts, and how many of them reach their goal.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fovea {

struct AtlasArguments {
  std::string target = "sphere";
  int runs = 200;
  int jobs = 0;  // 0: one for every two cores
  int seed = 1;
  std::vector<std::string> assignments;
  std::string out;
  bool resume = false;
  bool json = false;
};

// The subcommand, which fills `arguments`.
CLI::App* AddAtlas(CLI::App& app, AtlasArguments& arguments);

// Runs them and prints the figures; returns the program's exit code. Throws config::InputError.
int Atlas(const AtlasArguments& arguments);

}  // namespace fovea
