// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/terminal.hpp"

namespace fovea::contact {
namespace {

using Json = nlohmann::ordered_json;

Json RunsJson(const Runs& runs, Detector detector) {
  Json list = Json::array();
  for (std::size_t i = 0; i < kNumThresholds; ++i) {
    const FalseAlarms alarms = CountAlarms(runs.quiet, detector, i);
    Json at{{"threshold", ThresholdAt(i)},
            {"false_alarms", alarms.alarms},
            {"moving_s", alarms.moving_s},
            {"per_hour", alarms.PerHour()},
            {"per_hour_at_most", alarms.PerHourAtMost()},
            {"pushes", Json::array()}};
    for (const Place place : kPlaces) {
      for (std::size_t k = 0; k < kForces.size(); ++k) {
        const Detection d = Detect(runs.pushed.at(static_cast<std::size_t>(place)).at(k), detector, i);
        if (d.pushes > 0) {
          at["pushes"].push_back({{"place", Name(place)},
                                  {"force_n", kForces.at(k)},
                                  {"pushes", d.pushes},
                                  {"detected", d.detected},
                                  {"by_other_guards", d.by_others},
                                  {"median_ms", d.detected > 0 ? Json(d.median_ms) : Json(nullptr)},
                                  {"most_ms", d.detected > 0 ? Json(d.most_ms) : Json(nullptr)}});
        }
      }
    }
    list.push_back(at);
  }
  return list;
}

}  // namespace

std::string InWords(const Detection& d) {
  std::string text = fmt::format("{} of {}", d.detected + d.by_others, d.pushes);
  if (d.detected > 0) {
    text += fmt::format(", {:.0f} ms (at most {:.0f})", d.median_ms, d.most_ms);
  }
  return d.by_others > 0 ? text + fmt::format(", {} by others", d.by_others) : text;
}

std::string InWords(const FalseAlarms& alarms) {
  return fmt::format("{} in {:.1f} min (less than {:.0f} per hour)", alarms.alarms, alarms.moving_s / 60.0,
                     alarms.PerHourAtMost());
}

std::string Verdict(const Study& study) {
  const FalseAlarms alarms = CountAlarms(study.wrong.quiet, Detector::kBoth, study.threshold);
  const auto& hand = study.wrong.pushed.at(static_cast<std::size_t>(Place::kHand));
  std::vector<std::string> forces;
  for (std::size_t k = 0; k < kForces.size(); ++k) {
    const Detection d = Detect(hand.at(k), Detector::kBoth, study.threshold);
    forces.push_back(fmt::format("{:.0f} % at {:g} N", 100.0 * d.Share(), kForces.at(k)));
  }
  return fmt::format("With wrong beliefs: false alarms {}; the arm stops after pushes at the hand: {}",
                     InWords(alarms), fmt::join(forces, ", "));
}

std::string ToTable(const Study& study) {
  config::PrintedTable table(config::StyleOf(STDOUT_FILENO));
  table.Row("runs",
            fmt::format("{}, seed {}; motions: {}", study.runs, study.seed, fmt::join(study.motions, ", ")));
  for (const auto& [name, runs] :
       {std::pair<const char*, const Runs&>{"right beliefs", study.right}, {"wrong beliefs", study.wrong}}) {
    table.Row(name, "false alarms: " + InWords(CountAlarms(runs.quiet, Detector::kBoth, study.threshold)));
    for (const Place place : kPlaces) {
      for (std::size_t k = 0; k < kForces.size(); ++k) {
        const auto& pushed = runs.pushed.at(static_cast<std::size_t>(place)).at(k);
        if (!pushed.empty()) {
          table.Row(fmt::format("  {:g} N at the {}", kForces.at(k), Name(place)),
                    InWords(Detect(pushed, Detector::kBoth, study.threshold)));
        }
      }
    }
  }
  return table.text();
}

std::string ToJson(const Study& study) {
  Json json;
  json["seed"] = study.seed;
  json["runs"] = study.runs;
  json["motions"] = study.motions;
  json["threshold"] = ThresholdAt(study.threshold);
  json["sudden_weight"] = study.sudden_weight;
  json["good"] = IsGood(study);
  for (const Detector detector : kDetectors) {
    json["detectors"][Name(detector)] = {{"right", RunsJson(study.right, detector)},
                                         {"wrong", RunsJson(study.wrong, detector)}};
  }
  return json.dump(2) + "\n";
}

}  // namespace fovea::contact
