// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/replay/text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace fovea {
namespace {

using flight::Divergence;
using flight::FieldChange;
using flight::ReplayResult;
using flight::Segment;

constexpr std::size_t kMostLines = 40;

double Seconds(const ReplayResult& result, std::int64_t stamp_ns) {
  return 1e-9 * static_cast<double>(stamp_ns - result.start_ns);
}

std::string Begins(const Segment& segment) {
  return segment.from_keyframe ? fmt::format("from the keyframe of tick {}", segment.first_tick)
                               : "from the first tick";
}

std::string Verdict(const ReplayResult& result, const Segment& segment) {
  if (!segment.not_replayed.empty()) {
    return "not replayed: " + segment.not_replayed;
  }
  if (!segment.divergence) {
    return Begins(segment) + ": bit-identical";
  }
  const Divergence& d = *segment.divergence;
  std::string text =
      fmt::format("{}: differs at tick {}, {:.3f} s, in {}: recorded {}, replayed {}", Begins(segment),
                  d.tick, Seconds(result, d.stamp_ns), d.field, d.recorded, d.replayed);
  if (!d.state_group.empty()) {
    text += fmt::format("; the state's {} differs at the next keyframe", d.state_group);
  }
  return text;
}

}  // namespace

std::string ReplayText(const std::string& log, const ReplayResult& result) {
  std::string text =
      fmt::format("{}: {} ticks replayed, recorded by {}\n", log, result.ticks(),
                  result.same_build ? "this build of the servo" : "another build of the servo");
  for (std::size_t i = 0; i < result.segments.size(); ++i) {
    const Segment& segment = result.segments[i];
    text += fmt::format("  segment {:<3} {:9.3f} to {:.3f} s, {} ticks, {}\n", i + 1,
                        Seconds(result, segment.first_ns), Seconds(result, segment.last_ns), segment.ticks(),
                        Verdict(result, segment));
  }
  if (result.ticks_lost > 0) {
    text += fmt::format("  {} ticks are not in the log\n", result.ticks_lost);
  }
  if (!result.complete) {
    text += fmt::format("  {}\n", result.why_incomplete);
  }
  return text;
}

std::string ChangeTable(const ReplayResult& result) {
  if (result.changes.empty()) {
    return {};
  }
  std::string text = fmt::format("  {:<22} {:>8} {:>12} {:>12} {:>12}\n", "field", "ticks", "first at s",
                                 "by at most", "at s");
  std::size_t lines = 0;
  for (const FieldChange& change : result.changes) {
    if (++lines > kMostLines) {
      text += fmt::format("  and {} more fields\n", result.changes.size() - kMostLines);
      break;
    }
    const std::string most = std::isfinite(change.most) ? fmt::format("{:.3g}", change.most) : "-";
    text += fmt::format("  {:<22} {:>8} {:>12.3f} {:>12} {:>12.3f}\n", change.field, change.ticks,
                        Seconds(result, change.first_ns), most, Seconds(result, change.most_ns));
  }
  return text;
}

std::string ReplayJson(const std::string& log, const ReplayResult& result) {
  nlohmann::ordered_json json;
  json["log"] = log;
  json["identical"] = result.Identical();
  json["same_build"] = result.same_build;
  json["complete"] = result.complete;
  json["ticks"] = result.ticks();
  json["ticks_lost"] = result.ticks_lost;
  json["segments"] = nlohmann::json::array();
  for (const Segment& segment : result.segments) {
    nlohmann::ordered_json entry;
    entry["first_tick"] = segment.first_tick;
    entry["last_tick"] = segment.last_tick;
    entry["from_s"] = Seconds(result, segment.first_ns);
    entry["to_s"] = Seconds(result, segment.last_ns);
    entry["from_keyframe"] = segment.from_keyframe;
    if (!segment.not_replayed.empty()) {
      entry["not_replayed"] = segment.not_replayed;
    }
    if (segment.divergence) {
      const Divergence& d = *segment.divergence;
      entry["differs"] = {{"tick", d.tick},         {"t_s", Seconds(result, d.stamp_ns)},
                          {"field", d.field},       {"recorded", d.recorded},
                          {"replayed", d.replayed}, {"state", d.state_group}};
    }
    json["segments"].push_back(entry);
  }
  json["changes"] = nlohmann::json::array();
  for (const FieldChange& change : result.changes) {
    nlohmann::ordered_json entry{
        {"field", change.field}, {"ticks", change.ticks}, {"first_s", Seconds(result, change.first_ns)}};
    if (std::isfinite(change.most)) {
      entry["most"] = change.most;
      entry["most_s"] = Seconds(result, change.most_ns);
    }
    json["changes"].push_back(entry);
  }
  return json.dump(2) + "\n";
}

}  // namespace fovea
