// A folder for what another program writes.
#pragma once

#include <filesystem>

namespace fovea::bench {

// Of its own under the system's temporary folder, gone with the object.
class Scratch {
 public:
  Scratch();  // std::runtime_error when none can be made
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace fovea::bench
