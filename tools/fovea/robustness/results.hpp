// SPDX-License-Identifier: Apache-2.0
// What wrong beliefs cost a servo, and how wrong they may be: the results of many runs.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/figures.hpp"
#include "tools/fovea/robustness/bars.hpp"

namespace fovea::robustness {

// All quantities together, `size` times as large.
struct SizeFigures {
  double size = 1.0;
  atlas::Figures figures;
};

// How far a bar may differ to one side, in multiples of its stated end.
struct Margin {
  double borne = 0.0;  // largest tried one at which all starts converged, within limits, without contact
  std::optional<double> lost;  // least tried one at which a start did not; none: larger ones were not tried
  bool is_end = false;         // larger ones than `borne` cannot be
  std::string why;             // verdict of the first lost run
  std::string command;         // that repeats it
};

struct SideFigures {
  atlas::Figures stated;  // at the stated end
  std::optional<Margin> margin;
};

struct BarFigures {
  Bar bar;
  std::array<std::optional<SideFigures>, 2> sides;  // in order of Side; none: no difference to this side
};

struct Tornado {
  atlas::Figures none;  // all is as the servo believes
  atlas::Figures base;  // the same, only the starts of each bar
  atlas::Figures all;   // all quantities are drawn at once
  std::vector<BarFigures> bars;
  int starts = 0;  // of each bar and of its margin
};

// True when every run within the stated ends has a result, without an exceeded limit and without contact.
bool KeepsLimits(const Tornado& tornado);

}  // namespace fovea::robustness
