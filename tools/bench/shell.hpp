// Another program, run by the shell.
#pragma once

#include <string>

namespace fovea::bench {

// `text` as one word of a command.
std::string Quoted(const std::string& text);

struct ShellResult {
  bool done = false;   // it ended with exit code 0
  std::string output;  // what it printed
};

// Runs `command` to its end. Throws std::runtime_error when there is no shell.
ShellResult RunShell(const std::string& command);

}  // namespace fovea::bench
