// SPDX-License-Identifier: Apache-2.0
// The results of a robustness study as JSON, CSV and text.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/config/terminal.hpp"
#include "tools/fovea/robustness/results.hpp"

namespace fovea::robustness {

// "-5 to +5 mm": the stated ends.
std::string StatedRange(const Bar& bar);
// "-14 to +20 mm": what is borne. A ">" stands before the largest multiple that was tried, "(end)" after the
// largest difference that can be. "-" without margins.
std::string BorneRange(const BarFigures& bar);
// The worse side: "0.12 px, 5.1 mm, 2.4 s", medians. Or each side with failed runs: "1 of 3 failed at -5, 2
// of 3 failed at +5".
std::string CostOf(const BarFigures& bar);
// "20 of 20 (83.9 to 100 %)"
std::string SuccessOf(const atlas::Figures& figures);
// "0.12; 0.4" : median and most; "-" if no run converged.
std::string MedianAndMost(const std::optional<atlas::Spread>& spread);

// The bars, the costliest first: by lost runs, then by the image error.
std::vector<const BarFigures*> ByCost(const Tornado& tornado);

std::string ToJson(const Spec& spec, const std::vector<SizeFigures>& sizes);
std::string ToJson(const Spec& spec, const std::vector<Tornado>& targets);
// One line per size or per side of a bar; the first line has the names of the columns.
std::string ToCsv(const std::vector<SizeFigures>& sizes);
std::string ToCsv(const std::vector<Tornado>& targets);
std::string ToTable(const std::vector<SizeFigures>& sizes, const config::TextStyle& style);
std::string ToTable(const Tornado& tornado, const config::TextStyle& style);
// The page sim/ROBUSTNESS.md.
std::string ToMarkdown(const Spec& spec, const std::vector<Tornado>& targets);

}  // namespace fovea::robustness
