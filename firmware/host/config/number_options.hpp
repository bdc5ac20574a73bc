// SPDX-License-Identifier: Apache-2.0
// Rejects NaN and infinity in command-line numbers, whatever else an option checks.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace fovea::config {

// Adds the check to every option of `app` and of its subcommands that takes a real number. CLI11's own
// comparisons let NaN pass.
inline void RefuseNonFinite(CLI::App& app) {
  const CLI::Validator finite(
      [](std::string& text) {
        double value = 0.0;
        const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        return is_number ? std::string() : text + " is not allowed: expected a finite number";
      },
      "");
  for (CLI::Option* option : app.get_options({})) {
    if (option->get_type_name().rfind("FLOAT", 0) == 0) {
      option->check(finite);
    }
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    RefuseNonFinite(*command);
  }
}

}  // namespace fovea::config
