// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/report/error_components.hpp"

#include <fmt/format.h>

namespace fovea::report {

std::vector<ErrorComponent> ErrorComponentsOf(const log::Setup& setup) {
  std::vector<ErrorComponent> components;
  const auto add = [&](const std::string& unit, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      components.push_back({name, unit});
    }
  };
  const std::string& form = setup.feature();
  if (form == "corners") {
    for (int i = 0; 2 * i + 1 < setup.corners_size(); ++i) {
      components.push_back({fmt::format("x of corner {}", i + 1), "1"});
      components.push_back({fmt::format("y of corner {}", i + 1), "1"});
    }
  } else if (form == "pose") {
    add("m", {"X", "Y", "Z"});
    add("rad", {"turn about x", "turn about y", "turn about z"});
  } else if (form == "side" || form == "corner_side") {
    add("1", {"x", "y"});
    add("rad", {"angle of the upper side"});
    add("1", {"length of the upper side"});
  } else if (form == "circle") {
    add("1", {"X / Z", "Y / Z", "diameter / Z"});
  } else {
    add("1", {"X / radius", "Y / radius", "Z / radius"});
  }
  add("rad", {"held turn about x", "held turn about y", "held turn about z"});
  return components;
}

}  // namespace fovea::report
