// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/robots/shipped_robots.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <system_error>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/share_folder.hpp"

namespace fovea::robots {
namespace {

namespace fs = std::filesystem;

fs::path ShippedRobotsFolder() { return config::ShareFolder() / "robots"; }

}  // namespace

std::vector<std::string> ShippedRobots() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(ShippedRobotsFolder(), ignored)) {
    if (entry.path().extension() == ".toml") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool IsRobotPath(const fs::path& name_or_path) {
  return name_or_path.extension() == ".toml" || name_or_path.extension() == ".urdf";
}

fs::path FindRobot(const std::string& name_or_path, const std::string& where) {
  const fs::path given = name_or_path;
  if (IsRobotPath(given)) {
    return given;
  }
  const fs::path shipped = ShippedRobotsFolder() / (name_or_path + ".toml");
  std::error_code ignored;
  if (given == given.filename() && fs::is_regular_file(shipped, ignored)) {
    return shipped;
  }
  const std::vector<std::string> names = ShippedRobots();
  throw config::InputError(fmt::format(
      "{}: unknown arm \"{}\"{}; shipped are {} (or give the path of an arm file .toml or of a .urdf)", where,
      name_or_path, config::DidYouMean(name_or_path, names), fmt::join(names, ", ")));
}

}  // namespace fovea::robots
