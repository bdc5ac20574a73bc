// SPDX-License-Identifier: Apache-2.0
// fovea features: analyses what a target's feature controls.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "firmware/host/config/target_keys.hpp"

namespace fovea {

struct FeaturesArguments {
  config::TargetSettings target;
  std::string feature = "auto";
  bool hold_orientation = false;
  std::string pose = "0,0,0.4,1,0,0,0";
  std::string goal = "0,0,0.4,1,0,0,0";
  double focal_px = 0.0;
  bool tables = false;
  bool sweep = false;
  double span = 0.20;
  bool json = false;
};

// Adds the subcommand, which fills `arguments`.
CLI::App* AddFeatures(CLI::App& app, FeaturesArguments& arguments);

// Prints the requested analysis; returns the program's exit code. Throws config::InputError.
int Features(const FeaturesArguments& arguments);

}  // namespace fovea
