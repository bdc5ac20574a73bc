#include "scratch.hpp"

#include <stdlib.h>

#include <stdexcept>
#include <string>
#include <system_error>

namespace fovea::bench {

namespace fs = std::filesystem;

Scratch::Scratch() {
  // mkdtemp replaces the six letters by others that make the name one of its own: its way of being called.
  std::string name = (fs::temp_directory_path() / "fovea-bench-XXXXXX").string();
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
