// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/common/scratch.hpp"

#include <stdlib.h>

#include <stdexcept>
#include <string>
#include <system_error>

namespace fovea::bench {

namespace fs = std::filesystem;

Scratch::Scratch() {
  // mkdtemp requires six X at the end. It replaces them so that the name is unique.
  std::string name = (fs::temp_directory_path() / "fovea-bench-").string() + std::string(6, 'X');
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("cannot create a folder in " + fs::temp_directory_path().string());
  }
  path_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace fovea::bench
