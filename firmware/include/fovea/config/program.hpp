// What every program of the project does with its command line: exit codes, and errors on one line.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <stdexcept>

namespace fovea::config {

inline constexpr int kDone = 0;
inline constexpr int kGoalMissed = 1;  // the run failed its own goal
inline constexpr int kBadInput = 2;    // wrong usage or input

// Parses the command line into what `app` was given, then does `action`. Returns the program's exit code: of
// the action, or kBadInput after one line on standard error that begins with the program's `name`.
inline int RunProgram(const char* name, CLI::App& app, int argc, char** argv,
                      const std::function<int()>& action) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadInput;
  }
  try {
    const int code = action();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("standard output cannot be written");
    }
    return code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return kBadInput;
  }
}

}  // namespace fovea::config
