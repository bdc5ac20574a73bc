// Changes values of a TOML file and leaves the rest of its text as it is: comments, order, spaces.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fovea::config {

struct NewValue {
  std::string key;    // within the section, as "mount_xyz"
  std::string value;  // as TOML has it, as "[0.05, 0, 0.04]"
};

// `text` with `values` in its table [section]: where a key stands already its value is replaced, with what
// follows it on its line; else it is added at the end of the table. The table is added at the end of the text
// where there is none. InputError where the text says them in a way that is not changed here (a dotted key,
// an inline table).
std::string WithValues(const std::string& text, const std::string& section,
                       const std::vector<NewValue>& values);

// The same in a file, which is replaced at once or not at all. InputError, with the file's name.
void WriteValues(const std::filesystem::path& file, const std::string& section,
                 const std::vector<NewValue>& values);

}  // namespace fovea::config
