// Another program: the simulator beside this one, and what the shell runs.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::bench {

// Where fovea-sim is: in this program's folder. Throws std::runtime_error, which names who `needs` it, when
// it is not there.
std::filesystem::path SimulatorBeside(const std::string& needs);

// `text` as one word of a command.
std::string Quoted(const std::string& text);

struct ShellResult {
  bool done = false;   // it ended with exit code 0
  std::string output;  // what it printed
};

// Runs `command` to its end. Throws std::runtime_error when there is no shell.
ShellResult RunShell(const std::string& command);

}  // namespace fovea::bench
