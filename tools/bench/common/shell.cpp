// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/common/shell.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>

namespace fovea::bench {

std::filesystem::path SimulatorBeside(const std::string& needs) {
  std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "fovea-sim";
  if (!std::filesystem::is_regular_file(program)) {
    throw std::runtime_error(program.string() + ": not found; " + needs +
                             " needs the simulator in the same folder");
  }
  return program;
}

std::string Quoted(const std::string& text) {
  std::string quoted(1, '\'');
  for (const char c : text) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  quoted += '\'';
  return quoted;
}

ShellResult RunShell(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    throw std::runtime_error("a shell cannot be started");
  }
  ShellResult result;
  std::array<char, 4096> buffer{};
  while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) {
    result.output += buffer.data();
  }
  result.done = pclose(pipe) == 0;
  return result;
}

}  // namespace fovea::bench
