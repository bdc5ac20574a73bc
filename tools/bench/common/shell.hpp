// SPDX-License-Identifier: Apache-2.0
// Starts other programs: the simulator beside this one, and shell commands.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::bench {

// The path of fovea-sim in this program's folder. Throws std::runtime_error when it does not exist; the text
// names the command that `needs` it.
std::filesystem::path SimulatorBeside(const std::string& needs);

// `text` quoted as one word of a shell command.
std::string Quoted(const std::string& text);

struct ShellResult {
  bool done = false;   // it ended with exit code 0
  std::string output;  // what it printed
};

// Runs `command` to its end. Throws std::runtime_error when there is no shell.
ShellResult RunShell(const std::string& command);

}  // namespace fovea::bench
