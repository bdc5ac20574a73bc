// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fovea/robustness/text.hpp"

namespace fovea::robustness {
namespace {

constexpr const char* kHead = R"(# Robustness: results with wrong beliefs

Runs from random starts, in which arm and camera are not what the servo believes
([the section `[truth]`](scenarios/README.md#what-is-true-and-what-the-servo-believes)). The exit code is 1 when a
run within the stated ranges exceeds a limit. The image error is that of the true camera's picture. Printed by

)";

// The cells of one row, for all targets.
template <typename CellText>
std::string Row(const std::string& name, const std::vector<Tornado>& targets, const CellText& cell) {
  std::string text = "| " + name + " |";
  for (std::size_t i = 0; i < targets.size(); ++i) {
    text += fmt::format(" {} |", cell(i));
  }
  return text + "\n";
}

// `columns`: those before the targets'.
std::string HeadRow(const std::string& first, std::size_t columns, const std::vector<Tornado>& targets) {
  std::string text = Row(first, targets, [&](std::size_t i) { return targets[i].none.heading.target; });
  text += "|";
  for (std::size_t i = 0; i < columns + targets.size(); ++i) {
    text += "---|";
  }
  return text + "\n";
}

std::string Together(const std::vector<Tornado>& targets) {
  std::string text =
      "| target | errors | converged (Wilson, 95 %) | image error, median; most | position error, median; "
      "most | settled "
      "after, "
      "median; most | limit violations | runs with contact |\n|---|---|---|---|---|---|---|---|\n";
  for (const Tornado& tornado : targets) {
    for (const auto& [name, f] :
         {std::pair<const char*, const atlas::Figures&>{"none", tornado.none}, {"all", tornado.all}}) {
      text += fmt::format("| {} | {} | {} | {} px | {} mm | {} s | {} | {} |\n", f.heading.target, name,
                          SuccessOf(f), MedianAndMost(f.error_px), MedianAndMost(f.error_mm),
                          MedianAndMost(f.settle_s), f.limit_violations, f.contact_runs);
    }
  }
  return text;
}

}  // namespace

std::string ToMarkdown(const Spec& spec, const std::vector<Tornado>& targets) {
  std::string text = kHead;
  const atlas::Heading& heading = targets.front().none.heading;
  text += fmt::format(
      "```\nfovea atlas --robustness --runs {} --alone {} --seed {} --markdown > sim/ROBUSTNESS.md\n```\n\n"
      "All together:\n\n{}\n",
      targets.front().none.runs, targets.front().starts, heading.seed, Together(targets));
  text += fmt::format("They are drawn from `{}`:\n\n```\n", spec.name);
  for (const std::string& assignment : Scaled(spec, 1.0)) {
    text += assignment + "\n";
  }
  text += fmt::format(
      "```\n\n## Each alone, at its stated ends\n\n"
      "Image error, position error and settling time of the worse side: medians; starts: {}.\n\n{}",
      targets.front().starts, HeadRow("quantity | stated", 2, targets));
  for (std::size_t i = 0; i < targets.front().bars.size(); ++i) {
    const Bar& bar = targets.front().bars[i].bar;
    text += Row(fmt::format("`{}` | {}", NameOf(bar), StatedRange(bar)), targets,
                [&](std::size_t k) { return CostOf(targets[k].bars[i]); });
  }
  text += R"md(
## How wrong each may be

Each quantity alone. The stated end is multiplied by powers of the square root of 2, from 0.25 to 32; bisection finds the
largest multiple at which all starts converge, within limits and without contact. A start that fails without any error does
not count, and few starts are used: a range is an indication, not a guarantee. At the next one, 1.41 times as large, a
run fails. A ">" marks the largest multiple: it is borne. "(end)": larger differences cannot be, such as a negative mass.
A start with its target near the picture's edge bounds the wrong place and turn of the camera, too: the true camera must
see the target.

)md";
  text += HeadRow("quantity", 1, targets);
  for (std::size_t i = 0; i < targets.front().bars.size(); ++i) {
    text += Row(fmt::format("`{}`", NameOf(targets.front().bars[i].bar)), targets,
                [&](std::size_t k) { return BorneRange(targets[k].bars[i]); });
  }
  return text;
}

}  // namespace fovea::robustness
