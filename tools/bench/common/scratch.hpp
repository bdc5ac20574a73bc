// SPDX-License-Identifier: Apache-2.0
// A temporary folder for the output of another program.
#pragma once

#include <filesystem>

namespace fovea::bench {

// Creates a new folder in the system's temporary folder. The destructor deletes it.
class Scratch {
 public:
  Scratch();  // std::runtime_error when the folder cannot be created
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace fovea::bench
