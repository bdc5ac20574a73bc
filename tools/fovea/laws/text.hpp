// SPDX-License-Identifier: Apache-2.0
// A comparison of laws as a table, JSON and the Markdown page sim/LAWS.md.
#pragma once

#include <optional>
#include <string>

#include "tools/fovea/laws/study.hpp"

namespace fovea::laws {

// What a law did on all random starts with a target.
struct OnRandomStarts {
  int runs = 0;
  int converged = 0;
  std::optional<double> settle_s;     // median of the converged runs
  std::optional<double> excursion_m;  // median of all runs
};
OnRandomStarts OnRandom(const TargetStudy& study, const std::string& law);

std::string ToTable(const Study& study);
std::string ToJson(const Study& study);
std::string ToMarkdown(const Study& study);

}  // namespace fovea::laws
