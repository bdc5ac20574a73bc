// SPDX-License-Identifier: Apache-2.0
// Settings read from a TOML file or from the command line, before they are checked against known keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace fovea::config {

using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

struct Setting {
  std::string key;  // dotted, e.g. "camera.rate_hz"
  Value value;
  std::string where;  // "file.toml:12" or "--set"
};

// All settings of a TOML file, tables flattened to dotted keys, in the order of the file's keys.
// InputError: the file cannot be read, is not TOML, or holds a value of a kind that no key takes.
std::vector<Setting> ReadTomlFile(const std::filesystem::path& path);

// One "key=value" of the command line; the value in TOML, or bare text. InputError when it is neither.
Setting ParseAssignment(const std::string& text);

// The value in TOML.
std::string ToText(const Value& value);

}  // namespace fovea::config
