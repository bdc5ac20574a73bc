// SPDX-License-Identifier: Apache-2.0
// fovea gains: designs a PD regulator for one degree of freedom and computes its gain and delay limits.
#pragma once

#include <CLI/CLI.hpp>

namespace fovea {

struct GainsArguments {
  double mass = 0.0;
  double damping = 0.0;
  double stiffness = 0.0;
  double closed_loop_stiffness = 0.0;
  double damping_ratio = 1.0;
  double delay_ms = 0.0;
  double rate_hz = 1000.0;
  bool json = false;
};

// Adds the subcommand, which fills `arguments`.
CLI::App* AddGains(CLI::App& app, GainsArguments& arguments);

// Prints the design; returns the program's exit code. Throws config::InputError.
int Gains(const GainsArguments& arguments);

}  // namespace fovea
