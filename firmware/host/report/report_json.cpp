// SPDX-License-Identifier: Apache-2.0
// RunData as JSON for the page's scripts; long arrays as base64 of little-endian float32.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "firmware/host/recording/log/base64.hpp"
#include "firmware/host/report/report.hpp"

namespace fovea::report {
namespace {

using log::Base64;
using nlohmann::ordered_json;

std::string Base64(const std::vector<float>& values) {
  return log::Base64(
      std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
}

bool IsKnown(const std::vector<float>& values) {
  return std::any_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

ordered_json Ticks(const RunData& run) {
  const Envelope::Rows rows = run.ticks->rows();
  const std::size_t joints = run.joints.size();
  ordered_json ticks;
  ticks["t_s"] = Base64(rows.t_s);
  std::size_t column = 0;
  for (const char* name : {"q", "dq", "tau", "tau_meas", "tau_ext"}) {
    ticks[name] = ordered_json::array();
    for (std::size_t i = 0; i < joints; ++i) {
      ticks[name].push_back(Base64(rows.columns[column++]));
    }
  }
  const auto truth = [&](std::size_t which) {
    return run.has_truth ? ordered_json(Base64(rows.columns[column + which])) : ordered_json(nullptr);
  };
  ticks["error_px"] = truth(RunData::kErrorPx);
  ticks["error_mm"] = truth(RunData::kErrorMm);
  ticks["predicted_px"] = Base64(rows.columns[column + RunData::kPredictedPx]);
  // Null where there are no numbers.
  const auto known = [&](std::size_t which) {
    const std::vector<float>& values = rows.columns[column + which];
    return IsKnown(values) ? ordered_json(Base64(values)) : ordered_json(nullptr);
  };
  const auto list = [&](std::size_t first, std::size_t count) {
    ordered_json values = ordered_json::array();
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(known(first + i));
    }
    return values;
  };
  ticks["path_error_mm"] = known(RunData::kPathErrorMm);
  ticks["twist_cmd"] = list(RunData::kTwistCmd, 6);
  ticks["twist_meas"] = list(RunData::kTwistMeas, 6);
  ticks["e"] = list(RunData::kError, hal::kMaxFeatureDim);
  return ticks;
}

ordered_json Spans(const std::vector<FrameSpan>& spans) {
  ordered_json list = ordered_json::array();
  for (const FrameSpan& span : spans) {
    list.push_back({{"from_s", span.from_s}, {"to_s", span.to_s}, {"frames", span.frames}});
  }
  return list;
}

ordered_json FeaturePathOf(const PixelPath& path) {
  if (path.t_s.empty()) {
    return nullptr;
  }
  return {{"goal_px", Base64(path.goal_px)}, {"t_s", Base64(path.t_s)}, {"px", Base64(path.px)}};
}

ordered_json Frame(const RunData& run, const std::optional<EyeFrame>& frame) {
  if (!frame) {
    return nullptr;
  }
  ordered_json shapes = ordered_json::array();
  for (const EyeFrame::Outline& outline : frame->outlines) {
    shapes.push_back({{"role", outline.role}, {"points", outline.points_px}});
  }
  return {{"t_s", frame->t_s},
          {"width_px", run.width_px},
          {"height_px", run.height_px},
          {"jpeg", Base64(std::string_view(frame->jpeg))},
          {"shapes", shapes}};
}

constexpr double kLargestShown = 5.0;  // beside a larger workspace the arm would be too small to see [m]

ordered_json Scene(const RunData& run) {
  if (run.links.empty() || run.motion.t_s.empty()) {
    return nullptr;
  }
  ordered_json links = ordered_json::array();
  for (const SceneLink& link : run.links) {
    ordered_json shapes = ordered_json::array();
    for (const SceneShape& shape : link.shapes) {
      ordered_json entry = {{"kind", shape.kind},
                            {"size", shape.size},
                            {"position", shape.position},
                            {"quaternion", shape.quaternion},
                            {"colour", shape.colour}};
      if (!shape.vertices.empty()) {
        entry["vertices"] = Base64(shape.vertices);
      }
      shapes.push_back(entry);
    }
    links.push_back({{"name", link.frame}, {"shapes", shapes}});
  }
  return {{"links", links},
          {"t_s", Base64(run.motion.t_s)},
          {"poses", Base64(run.motion.poses)},
          {"camera_path", Base64(run.motion.camera_path)},
          {"target_path",
           IsKnown(run.motion.target_path) ? ordered_json(Base64(run.motion.target_path)) : nullptr},
          {"target_turn",
           IsKnown(run.motion.target_turn) ? ordered_json(Base64(run.motion.target_turn)) : nullptr},
          {"workspace_radius",
           run.workspace_radius > kLargestShown ? ordered_json(nullptr) : ordered_json(run.workspace_radius)},
          {"table_z", 0.0}};
}

// Discarded if it is not JSON. Drops values nested deeper than a summary's: writing them recurses as deep.
ordered_json ParseFlat(const std::string& text) {
  constexpr int kDeepest = 16;
  return ordered_json::parse(
      text, [](int depth, ordered_json::parse_event_t, ordered_json&) { return depth <= kDeepest; }, false);
}

// The keys in TOML.
std::string Configuration(const std::map<std::string, std::string>& keys) {
  std::string text;
  std::string section;
  for (const auto& [name, value] : keys) {
    const auto dot = name.find('.');
    if (name.substr(0, dot) != section) {
      section = name.substr(0, dot);
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("{} = {}\n", name.substr(dot + 1), value);
  }
  return text;
}

// Null when the log does not contain the defaults.
ordered_json ChangedKeys(const RunData& run) {
  const auto keys = run.metadata.find("configuration");
  const auto defaults = run.metadata.find("defaults");
  if (keys == run.metadata.end() || defaults == run.metadata.end()) {
    return nullptr;
  }
  ordered_json changed = ordered_json::array();
  for (const auto& [key, text] : defaults->second) {
    const auto used = keys->second.find(key);
    if (used != keys->second.end()) {
      changed.push_back({{"key", key}, {"value", used->second}, {"default", text}});
    }
  }
  return changed;
}

}  // namespace

std::string ToJson(const RunData& run) {
  ordered_json json;
  json["name"] = run.name;
  json["source"] = std::filesystem::path(run.source).filename().string();
  json["incomplete"] = run.complete ? ordered_json(nullptr) : ordered_json(run.why_incomplete);
  json["summary"] = run.summary_json ? ParseFlat(*run.summary_json) : ordered_json(nullptr);
  if (json["summary"].is_discarded()) {
    json["summary"] = nullptr;
  }
  json["info"] = ordered_json::object();
  for (const auto& [name, entries] : run.metadata) {
    for (const auto& [key, value] : entries) {
      if (name != "configuration" && name != "defaults" && name != "run") {
        json["info"][name == "build" ? key : fmt::format("{} {}", name, key)] = value;
      }
    }
  }
  json["changed"] = ChangedKeys(run);
  const auto about = run.metadata.find("run");
  const bool has_command = about != run.metadata.end() && about->second.count("command") == 1;
  json["command"] = has_command ? ordered_json(about->second.at("command")) : ordered_json(nullptr);
  const auto keys = run.metadata.find("configuration");
  json["config"] = keys == run.metadata.end() ? std::string() : Configuration(keys->second);
  json["duration_s"] = run.duration_s;
  json["lambda"] = run.lambda;
  // A run without a target had no camera.
  json["target"] = run.target_radius == 0.0 ? ordered_json(nullptr)
                                            : ordered_json({{"kind", run.target_kind},
                                                            {"radius_m", run.target_radius},
                                                            {"corners_m", run.target_corners},
                                                            {"moves", run.target_moves}});
  json["joints"] = ordered_json::array();
  for (const JointInfo& joint : run.joints) {
    json["joints"].push_back({{"name", joint.name},
                              {"type", joint.prismatic ? "prismatic" : "revolute"},
                              {"q_min", joint.q_min},
                              {"q_max", joint.q_max},
                              {"dq_max", joint.dq_max},
                              {"tau_max", joint.tau_max}});
  }
  json["ticks"] = Ticks(run);
  const Envelope::Rows measured = run.measured.rows();
  json["measured"] = {{"t_s", Base64(measured.t_s)},
                      {"error_px", Base64(measured.columns[RunData::kMeasuredPx])},
                      {"age_ms", Base64(measured.columns[RunData::kAgeMs])},
                      {"confidence", Base64(measured.columns[RunData::kConfidence])}};
  json["theory"] = nullptr;
  if (run.has_theory) {
    const Envelope::Rows rows = run.theory.rows();
    json["theory"] = {{"t_s", Base64(rows.t_s)},
                      {"x", Base64(rows.columns[RunData::kTheoryX])},
                      {"goal", Base64(rows.columns[RunData::kTheoryGoal])},
                      {"analytic", Base64(rows.columns[RunData::kTheoryAnalytic])}};
  }
  json["error_components"] = ordered_json::array();
  for (const ErrorComponent& component : run.error_components) {
    json["error_components"].push_back({{"name", component.name}, {"unit", component.unit}});
  }
  json["width_px"] = run.width_px;
  json["height_px"] = run.height_px;
  json["feature_path"] = FeaturePathOf(run.feature_path);
  json["frames_taken"] = run.frames_taken;
  json["lost"] = Spans(run.lost);
  json["not_found"] = Spans(run.not_found);
  json["modes"] = ordered_json::array();
  for (const ModeChange& change : run.modes) {
    json["modes"].push_back({{"t_s", change.t_s}, {"mode", change.mode}, {"reason", change.reason}});
  }
  json["ways"] = ordered_json::array();
  for (const WayChange& change : run.ways) {
    json["ways"].push_back({{"t_s", change.t_s}, {"way", change.way}, {"why", change.why}});
  }
  json["faults"] = ordered_json::array();
  for (const FaultNote& fault : run.faults) {
    json["faults"].push_back(
        {{"t_s", fault.t_s}, {"name", fault.name}, {"key", fault.key}, {"detail", fault.detail}});
  }
  json["tunings"] = ordered_json::array();
  for (const TuningEvent& tuning : run.tunings) {
    json["tunings"].push_back({{"t_s", tuning.t_s}, {"taken", tuning.taken}, {"words", tuning.words}});
  }
  json["touches"] = ordered_json::array();
  for (const TouchEvent& touch : run.touches) {
    json["touches"].push_back({{"t_s", touch.t_s}, {"words", touch.words}});
  }
  json["limits_active"] = ordered_json::array();
  for (const LimitSpans& limit : run.limits_active) {
    json["limits_active"].push_back({{"name", limit.name}, {"spans", limit.spans_s}});
  }
  json["tick_times"] = run.tick_counts.empty()
                           ? ordered_json(nullptr)
                           : ordered_json({{"upper_us", run.tick_upper_us}, {"counts", run.tick_counts}});
  json["frames"] =
      run.first_frame
          ? ordered_json({{"first", Frame(run, run.first_frame)}, {"last", Frame(run, run.last_frame)}})
          : ordered_json(nullptr);
  json["video"] = run.video ? ordered_json(Base64(std::string_view(*run.video))) : ordered_json(nullptr);
  json["scene"] = Scene(run);
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace fovea::report
