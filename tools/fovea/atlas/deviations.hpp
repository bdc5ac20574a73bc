// SPDX-License-Identifier: Apache-2.0
// The results of runs with wrong beliefs, against the size of each deviation that they drew.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/rows.hpp"

namespace fovea::atlas {

// The runs with similar deviations.
struct DeviationClass {
  double least = 0.0;  // deviation, true less believed value
  double most = 0.0;
  int runs = 0;
  int converged = 0;
  std::optional<double> median_px;  // this and the next: of the converged runs
  std::optional<double> median_mm;
};

// One entry of a quantity.
struct Deviation {
  std::string key;
  std::string unit;
  int entry = 1;
  std::vector<DeviationClass> classes;  // thirds of the runs, from the lowest to the highest deviation
};

// Of the rows with an index below `runs`. A row without a deviation of the quantity counts as one of 0.
std::vector<Deviation> DeviationsOf(const std::map<int, Row>& rows, int runs);

nlohmann::ordered_json DeviationsAsJson(const std::vector<Deviation>& deviations);
// A section of atlas.html; "" without deviations.
std::string DeviationsAsHtml(const std::vector<Deviation>& deviations);

}  // namespace fovea::atlas
