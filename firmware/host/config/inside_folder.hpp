// SPDX-License-Identifier: Apache-2.0
// Checks where a file lies that another file refers to.
#pragma once

#include <filesystem>

namespace fovea::config {

// Whether `file`, an absolute path or one relative to `folder`, lies in `folder` or below it after `..` and
// links are resolved. Parts of a path that do not exist count by their names.
[[nodiscard]] bool IsInside(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace fovea::config
