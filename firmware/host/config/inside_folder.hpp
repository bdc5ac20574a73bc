// Where a file lies that another file names.
#pragma once

#include <filesystem>

namespace fovea::config {

// Whether `file`, an absolute path or one relative to `folder`, lies in `folder` or below it once `..` and
// links are followed. What is not there counts by its name.
[[nodiscard]] bool IsInside(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace fovea::config
