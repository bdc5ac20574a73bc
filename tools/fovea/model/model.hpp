// SPDX-License-Identifier: Apache-2.0
// fovea model: kinematics and dynamics of an arm at a state, its limits, and checks of the model.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fovea {

struct ModelArguments {
  std::string robot;
  std::vector<double> at;  // q, or q and dq, or q, dq and ddq; empty: the ready posture at rest
  bool json = false;
  bool emit_cpp = false;
};

// Adds the subcommand, which fills `arguments`.
CLI::App* AddModel(CLI::App& app, ModelArguments& arguments);

// Prints the model; returns the program's exit code. Throws config::InputError.
int Model(const ModelArguments& arguments);

}  // namespace fovea
