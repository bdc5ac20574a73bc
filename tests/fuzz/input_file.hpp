// SPDX-License-Identifier: Apache-2.0
// Writes an input to a file for code that reads files. One file per process, overwritten for each input.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "tests/support/temp_folder.hpp"

namespace fovea::fuzz {

class InputFile {
 public:
  explicit InputFile(const std::string& name) : path_(folder_.path() / name) {}

  const std::filesystem::path& Write(std::span<const std::uint8_t> bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path_;
  }

 private:
  test::TempFolder folder_;
  std::filesystem::path path_;
};

// Whether an error message is one non-empty line.
inline bool IsOneLine(const std::string& text) {
  return !text.empty() && text.find('\n') == std::string::npos;
}

}  // namespace fovea::fuzz
