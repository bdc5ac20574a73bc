// SPDX-License-Identifier: Apache-2.0
// Charts of a robustness study, as SVG.
#pragma once

#include <string>
#include <vector>

#include "tools/fovea/robustness/results.hpp"

namespace fovea::robustness {

// What a chart shows of a set of runs.
struct Measure {
  const char* name;  // "image error"
  const char* unit;
  std::optional<atlas::Spread> atlas::Figures::*spread;
};
const std::vector<Measure>& Measures();

// Two bars for each quantity, the costliest quantity on top: from the median without errors to the median at
// the low and at the high stated end. A thin line ends at the largest value. A vertical line shows the median
// with all quantities together.
std::string TornadoChart(const Tornado& tornado, const Measure& measure);

// The share of runs that converge, with Wilson's interval, over the size of all differences.
std::string SuccessChart(const std::vector<SizeFigures>& sizes);
// The median of a measure over the size, with a line to the largest value.
std::string MeasureChart(const std::vector<SizeFigures>& sizes, const Measure& measure);

}  // namespace fovea::robustness
