// Small files of an atlas, read and written whole.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::atlas {

// What stands in `file`; "" when it cannot be read.
std::string Content(const std::filesystem::path& file);
std::string FirstLine(const std::string& text);
// InputError: it cannot be written.
void WriteFile(const std::filesystem::path& file, const std::string& content);

}  // namespace fovea::atlas
