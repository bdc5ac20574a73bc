// SPDX-License-Identifier: Apache-2.0
// Finds an arm by its name or by the path of its file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fovea::robots {

// The names of the shipped arms, sorted.
std::vector<std::string> ShippedRobots();

// Whether `name_or_path` is the path of an arm file (.toml) or of a .urdf.
bool IsRobotPath(const std::filesystem::path& name_or_path);

// The file of an arm: a path as it stands, otherwise that of the shipped arm of this name. InputError, which
// begins with `where` (the key or option that names the arm), gives the nearest name and all names.
std::filesystem::path FindRobot(const std::string& name_or_path, const std::string& where);

}  // namespace fovea::robots
