#include "tools/bench/common/scratch.hpp"

#include <stdlib.h>

#include <stdexcept>
#include <string>
#include <system_error>

namespace fovea::bench {

namespace fs = std::filesystem;

Scratch::Scratch() {
  // mkdtemp replaces the last six letters, which it wants to be these, by others that make the name one of
  // its own.
  std::string name = (fs::temp_directory_path() / "fovea-bench-").string() + std::string(6, 'X');
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("no folder can be made in " + fs::temp_directory_path().string());
  }
  path_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace fovea::bench
