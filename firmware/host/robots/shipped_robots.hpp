// SPDX-License-Identifier: Apache-2.0
// Finds a shipped arm by its name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fovea::robots {

// The names of the shipped arms, sorted.
std::vector<std::string> ShippedRobots();

// Whether `name_or_path` is the path of an arm file (.toml) or of a .urdf.
bool IsRobotPath(const std::filesystem::path& name_or_path);

// The file of the shipped arm `name`. InputError, which begins with `where` (the key or option that names
// it), gives the nearest name and all names, and ends with `otherwise`: what else is allowed there.
std::filesystem::path FindShippedRobot(const std::string& name, const std::string& where,
                                       const std::string& otherwise);

inline constexpr const char* kOrRobotPath = " (or give the path of an arm file .toml or of a .urdf)";

}  // namespace fovea::robots
