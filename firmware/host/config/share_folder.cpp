// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/share_folder.hpp"

namespace fovea::config {

std::filesystem::path ShareFolder() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return program.parent_path().parent_path() / "share" / "fovea";
}

}  // namespace fovea::config
