// SPDX-License-Identifier: Apache-2.0
// Changes values of a TOML file and keeps the rest of its text: comments, order, spaces.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fovea::config {

struct NewValue {
  std::string key;    // within the section, for example "mount_xyz"
  std::string value;  // in TOML, for example "[0.05, 0, 0.04]"
};

// The section as text: its header and a line for each value.
std::string SectionText(const std::string& section, const std::vector<NewValue>& values);

// Returns `text` with `values` in its table [section]. Replaces an existing key's value and the rest of its
// line; adds a new key directly after the section's header; adds a missing table at the end of the text.
// InputError when the text writes them in a form that cannot be edited here (a dotted key, an inline table).
std::string WithValues(const std::string& text, const std::string& section,
                       const std::vector<NewValue>& values);

// The same for a file, which is replaced atomically. InputError with the file's name.
void WriteValues(const std::filesystem::path& file, const std::string& section,
                 const std::vector<NewValue>& values);

}  // namespace fovea::config
