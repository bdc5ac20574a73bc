// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/bench/common/html_text.hpp"
#include "tools/fovea/contact/chart.hpp"
#include "tools/fovea/contact/text.hpp"

namespace fovea::contact {
namespace {

using bench::Escaped;

constexpr const char* kStyle =
    "<style>.wide{overflow-x:auto}.wide td,.wide th{white-space:nowrap;vertical-align:top}"
    ".swatch{display:inline-block;width:1em;height:.8em;border:1px solid var(--ink)}</style>";

std::string Figure(const char* name, const std::string& chart) {
  return fmt::format("<figure><h3>{}</h3>{}</figure>", name, chart);
}

// One row per threshold of the servo's detector.
std::string Rows(const Study& study) {
  std::string rows;
  for (std::size_t i = 0; i < kNumThresholds; ++i) {
    rows += fmt::format("<tr><th scope=\"row\">{:.0f} %{}</th><td>{}</td>", 100.0 * ThresholdAt(i),
                        i == study.threshold ? " (default)" : "",
                        Escaped(InWords(CountAlarms(study.wrong.quiet, Detector::kBoth, i))));
    for (const Place place : kPlaces) {
      for (const auto& pushed : study.wrong.pushed.at(static_cast<std::size_t>(place))) {
        rows += fmt::format("<td>{}</td>", Escaped(InWords(Detect(pushed, Detector::kBoth, i))));
      }
    }
    rows += "</tr>";
  }
  return rows;
}

std::string Heads() {
  std::string heads = "<th scope=\"col\">threshold</th><th scope=\"col\">false alarms</th>";
  for (const Place place : kPlaces) {
    for (const double force : kForces) {
      heads += fmt::format("<th scope=\"col\">{}, {:g} N</th>", Name(place), force);
    }
  }
  return heads;
}

}  // namespace

std::string ToHtml(const Study& study) {
  return fmt::format(
      "{}<section id=\"verdict\"><div class=\"banner {}\"><div><p class=\"run-tag\">{} runs, seed {}; "
      "motions: "
      "{}</p><p class=\"verdict-word\">{}</p><p class=\"verdict-sentence\">{}</p></div></div></section>"
      "<section><h2>Detection against false alarms</h2><p class=\"hint\">{}Solid: the servo's detector, "
      "whose "
      "limit of a sudden torque is {:g} times lower; dashed: the total torque alone. Masses are wrong by up "
      "to "
      "20 %. A dot or a ring is at the default threshold.</p><div class=\"columns\">{}{}{}{}</div></section>"
      "<section><h2>Each threshold of the servo's detector</h2><div class=\"wide\" tabindex=\"0\" "
      "role=\"region\" aria-label=\"Results of each threshold\"><table><thead><tr>{}</tr></thead><tbody>{}"
      "</tbody></table></div></section>",
      kStyle, IsGood(study) ? "good" : "bad", study.runs, study.seed, fmt::join(study.motions, ", "),
      IsGood(study) ? "No false alarm, every hard push noticed" : "A false alarm, or a hard push missed",
      Escaped(Verdict(study)), ForceLegend(), study.sudden_weight,
      Figure("Receiver operating characteristic", RocChart(study)),
      Figure("False alarms (green: right beliefs)", AlarmChart(study)),
      Figure("Pushes at the hand", DetectionChart(study, Place::kHand)),
      Figure("Pushes at the elbow", DetectionChart(study, Place::kElbow)), Heads(), Rows(study));
}

}  // namespace fovea::contact
