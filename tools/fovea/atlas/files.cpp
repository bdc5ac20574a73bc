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

std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string ReasonOf(const std::string& said) {
  std::string line = FirstLine(said);
  for (const std::string begin : {"fovea-sim: ", "--set: "}) {
    if (line.rfind(begin, 0) == 0) {
      line.erase(0, begin.size());
    }
  }
  return line;
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
