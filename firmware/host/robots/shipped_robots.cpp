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

fs::path FindShippedRobot(const std::string& name, const std::string& where, const std::string& otherwise) {
  const fs::path shipped = ShippedRobotsFolder() / (name + ".toml");
  std::error_code ignored;
  if (fs::path(name) == fs::path(name).filename() && fs::is_regular_file(shipped, ignored)) {
    return shipped;
  }
  const std::vector<std::string> names = ShippedRobots();
  const std::string nearest = config::Nearest(name, names);
  throw config::InputError(fmt::format("{}: unknown arm \"{}\"{}; shipped are {}{}", where, name,
                                       nearest.empty() ? "" : "; did you mean " + nearest + "?",
                                       fmt::join(names, ", "), otherwise));
}

}  // namespace fovea::robots
