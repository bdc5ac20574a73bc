// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/files.hpp"

#include <fstream>
#include <sstream>

#include "firmware/host/config/input_error.hpp"

namespace fovea::atlas {

std::string Content(const std::filesystem::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

std::string ReasonOf(const std::string& said) {
  const std::string own = "fovea-sim: ";
  std::string reason = "no reason is given; is the disk full?";
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(own)) {
      reason = line.substr(own.size());
    }
  }
  const std::string set = "--set: ";
  return reason.starts_with(set) ? reason.substr(set.size()) : reason;
}

void CheckWritable(const std::filesystem::path& file) {
  if (!std::ofstream(file, std::ios::binary | std::ios::app)) {
    throw config::InputError(file.string() + ": cannot be written");
  }
}

void WriteFile(const std::filesystem::path& file, const std::string& content) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << content;
  stream.close();
  if (!stream) {
    throw config::InputError(file.string() + ": cannot be written");
  }
}

}  // namespace fovea::atlas
