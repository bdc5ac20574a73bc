// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/inside_folder.hpp"

#include <algorithm>

namespace fovea::config {

namespace fs = std::filesystem;

bool IsInside(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path top = fs::weakly_canonical(fs::absolute(folder / "."), error);
  if (error) {
    return false;
  }
  const fs::path place = fs::weakly_canonical(fs::absolute(folder / file), error);
  if (error) {
    return false;
  }
  const fs::path above = top.has_filename() ? top : top.parent_path();  // without a trailing slash
  return std::mismatch(above.begin(), above.end(), place.begin(), place.end()).first == above.end();
}

}  // namespace fovea::config
