// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/common/figure.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace fovea::bench {

std::string ToJson(const std::vector<Figure>& figures) {
  nlohmann::json list = nlohmann::json::array();
  for (const Figure& figure : figures) {
    nlohmann::json entry{{"name", figure.name}, {"value", nullptr}, {"unit", figure.unit}, {"goal", nullptr}};
    if (std::isfinite(figure.value)) {
      entry["value"] = figure.value;
    }
    if (figure.goal) {
      entry["goal"] = *figure.goal;
    }
    list.push_back(entry);
  }
  return list.dump(2);
}

std::string ToTable(const std::vector<Figure>& figures) {
  std::string text;
  for (const Figure& figure : figures) {
    text += fmt::format("  {:<28}{:>12.5g} {}", figure.name, figure.value, figure.unit);
    text += figure.goal ? fmt::format("   (goal {:g})\n", *figure.goal) : "\n";
  }
  return text;
}

}  // namespace fovea::bench
