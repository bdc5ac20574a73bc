// SPDX-License-Identifier: Apache-2.0
// The output of every benchmark: figures with stable names.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fovea::bench {

struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;
  std::optional<double> goal;  // empty: none
};

// As a JSON list of {name, value, unit, goal}.
std::string ToJson(const std::vector<Figure>& figures);

// As lines of name, value, unit and goal.
std::string ToTable(const std::vector<Figure>& figures);

}  // namespace fovea::bench
