// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/rows.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "firmware/host/config/input_error.hpp"

namespace fovea::atlas {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::optional<double> NumberOrNone(const nlohmann::json& value) {
  return value.is_number() ? std::optional<double>(value.get<double>()) : std::nullopt;
}

Json ToJson(const Heading& heading) {
  Json json;
  json["atlas"] = heading.target;
  json["seed"] = heading.seed;
  json["set"] = heading.assignments;
  json["servo"] = heading.servo;
  json["truth"] = heading.truth;
  json["starts"] = heading.starts;
  return json;
}

Heading HeadingOf(const nlohmann::json& json) {
  return {json.at("atlas"), json.at("seed"),  json.at("set"),
          json.at("servo"), json.at("truth"), json.at("starts")};
}

Json ToJson(const Start& start) {
  Json rejections;
  for (std::size_t i = 0; i < start.rejections.size(); ++i) {
    rejections[kRejectionNames[i]] = start.rejections[i];
  }
  Json json;
  json["q"] = start.q;
  json["p_BO"] = {start.p_BO.x(), start.p_BO.y(), start.p_BO.z()};
  json["rpy_deg"] = start.rpy_deg;
  json["run_seed"] = start.run_seed;
  json["way_seed"] = start.way_seed;
  json["u_px"] = start.u_px;
  json["v_px"] = start.v_px;
  json["depth"] = start.depth;
  json["tilt_deg"] = start.tilt_deg;
  json["error_px"] = start.error_px;
  json["rejections"] = rejections;
  json["line"] = start.line;
  if (start.goal) {
    json["goal"] = {{"xyz", start.goal->xyz}, {"rpy_deg", start.goal->rpy_deg}};
  }
  return json;
}

Start StartOf(const nlohmann::json& json) {
  Start start;
  start.q = json.at("q").get<std::vector<double>>();
  for (int i = 0; i < 3; ++i) {
    start.p_BO[i] = json.at("p_BO").at(static_cast<std::size_t>(i));
  }
  start.rpy_deg = json.at("rpy_deg");
  start.run_seed = json.at("run_seed");
  start.way_seed = json.at("way_seed");
  start.u_px = json.at("u_px");
  start.v_px = json.at("v_px");
  start.depth = json.at("depth");
  start.tilt_deg = json.at("tilt_deg");
  start.error_px = json.at("error_px");
  for (std::size_t i = 0; i < start.rejections.size(); ++i) {
    start.rejections[i] = json.at("rejections").at(kRejectionNames[i]);
  }
  start.line = json.at("line");
  if (json.contains("goal")) {
    start.goal = Goal{json.at("goal").at("xyz"), json.at("goal").at("rpy_deg")};
  }
  return start;
}

Json ToJson(const Drawn& drawn) {
  return {{"key", drawn.key},
          {"entry", drawn.entry},
          {"unit", drawn.unit},
          {"believed", drawn.believed},
          {"true", drawn.actual}};
}

std::vector<Drawn> DrawnOf(const nlohmann::json& rows) {
  std::vector<Drawn> list;
  for (const nlohmann::json& row : rows) {
    list.push_back({row.at("key"), row.at("unit"), row.at("entry"), row.at("believed"), row.at("true")});
  }
  return list;
}

// The entries that differ of each quantity in a summary.
std::vector<Drawn> DrawnInSummary(const nlohmann::json& truth) {
  std::vector<Drawn> list;
  for (const auto& [key, value] : truth.items()) {
    const auto believed = value.at("believed").get<std::vector<double>>();
    const auto actual = value.at("true").get<std::vector<double>>();
    for (std::size_t i = 0; i < believed.size(); ++i) {
      if (actual.at(i) != believed[i]) {
        list.push_back({key, value.at("unit"), static_cast<int>(i) + 1, believed[i], actual[i]});
      }
    }
  }
  return list;
}

Json ToJson(const Row& row) {
  Json json;
  json["run"] = row.index;
  json["case"] = row.case_name;
  json["truth_set"] = row.truth;
  json["truth"] = Json::array();
  for (const Drawn& drawn : row.drawn) {
    json["truth"].push_back(ToJson(drawn));
  }
  json["refused"] = row.refused;
  json["start"] = ToJson(row.start);
  json["converged"] = row.converged;
  json["verdict"] = row.verdict;
  json["limit_violations"] = row.limit_violations;
  json["contact_ticks"] = row.contact_ticks;
  json["settle_time_s"] = OrNull(row.settle_time_s);
  json["final_error_px_rms"] = OrNull(row.final_error_px);
  json["final_error_mm"] = OrNull(row.final_error_mm);
  json["final_error_deg"] = OrNull(row.final_error_deg);
  json["error_px_max"] = OrNull(row.error_px_max);
  json["camera_path_m"] = OrNull(row.camera_path_m);
  json["camera_excursion_m"] = OrNull(row.camera_excursion_m);
  json["limits"] = row.limits;
  json["end"] = {{"mode", row.end_mode}, {"reason", row.end_reason}};
  json["log_hash"] = row.log_hash;
  return json;
}

Json ToJson(int index, const Judgement& judgement) {
  return {{"judged", index},
          {"has_way", judgement.has_way},
          {"length_rad", judgement.length},
          {"draws", judgement.draws},
          {"goals", judgement.goals}};
}

// Reads the keys that a summary and a row have in common.
void ReadResult(const nlohmann::json& json, Row& row) {
  row.converged = json.at("converged");
  row.verdict = json.at("verdict");
  row.limit_violations = json.at("limit_violations");
  row.contact_ticks = json.at("contact_ticks");
  row.settle_time_s = NumberOrNone(json.at("settle_time_s"));
  row.final_error_px = NumberOrNone(json.at("final_error_px_rms"));
  row.final_error_mm = NumberOrNone(json.at("final_error_mm"));
  row.final_error_deg = NumberOrNone(json.at("final_error_deg"));
  row.error_px_max = NumberOrNone(json.at("error_px_max"));
  row.camera_path_m = NumberOrNone(json.at("camera_path_m"));
  row.camera_excursion_m = NumberOrNone(json.at("camera_excursion_m"));
  row.limits = json.at("limits").get<std::map<std::string, double>>();
  row.end_mode = json.at("end").at("mode");
  row.end_reason = json.at("end").at("reason");
  row.log_hash = json.at("log_hash");
}

}  // namespace

Row MakeRow(int index, const Start& start, const nlohmann::json& summary) {
  constexpr double kSamePx = 0.5;  // angles are written to 0.01 deg
  Row row;
  row.index = index;
  row.start = start;
  ReadResult(summary, row);
  row.drawn = DrawnInSummary(summary.at("truth"));
  const std::optional<double> seen_px = NumberOrNone(summary.at("start_error_px"));
  if (!row.drawn.empty()) {
    return row;  // the true camera sees the target elsewhere than the sampler's
  }
  if (!seen_px || std::fabs(*seen_px - start.error_px) > kSamePx) {
    throw std::runtime_error(fmt::format(
        "run {}: the target starts {} px from its goal in the simulator, {:.2f} px in the sampler; "
        "arm, camera and servo.goal must be the same in both",
        index, seen_px ? fmt::format("{:.2f}", *seen_px) : "?", start.error_px));
  }
  return row;
}

RowFile::RowFile(const std::filesystem::path& file, const Heading& heading, bool resume) : file_(file) {
  const bool goes_on = resume && std::filesystem::exists(file);
  if (goes_on) {
    Read(heading);
  }
  stream_.open(file, std::ios::binary | (goes_on ? std::ios::app : std::ios::trunc));
  if (!stream_) {
    throw config::InputError(file.string() + ": cannot be written");
  }
  if (!goes_on) {
    Write(ToJson(heading).dump());
  }
}

void RowFile::Read(const Heading& heading) {
  std::ostringstream content;
  content << std::ifstream(file_, std::ios::binary).rdbuf();
  const std::string text = content.str();
  std::size_t whole = 0;  // bytes of complete lines
  try {
    for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', whole)) {
      const nlohmann::json json = nlohmann::json::parse(text.begin() + static_cast<std::ptrdiff_t>(whole),
                                                        text.begin() + static_cast<std::ptrdiff_t>(end));
      if (whole == 0) {
        if (HeadingOf(json) != heading) {
          throw config::InputError(fmt::format(
              "{}: rows of another --target, --seed, --set, --truth, --starts or servo library; omit "
              "--resume to start again",
              file_.string()));
        }
      } else {
        ReadLine(json);
      }
      whole = end + 1;
    }
  } catch (const nlohmann::json::exception&) {
    throw config::InputError(fmt::format(
        "{}: not a row of an atlas from byte {} on; omit --resume to start again", file_.string(), whole));
  }
  if (whole == 0) {
    throw config::InputError(file_.string() + ": contains no atlas; omit --resume to start again");
  }
  std::filesystem::resize_file(file_, whole);
}

void RowFile::ReadLine(const nlohmann::json& json) {
  if (json.contains("judged")) {
    judgements_[json.at("judged").get<int>()] = {json.at("has_way"), json.at("length_rad"), json.at("draws"),
                                                 json.at("goals")};
    return;
  }
  Row row;
  row.index = json.at("run");
  row.case_name = json.at("case");
  row.truth = json.at("truth_set").get<std::vector<std::string>>();
  row.drawn = DrawnOf(json.at("truth"));
  row.refused = json.at("refused");
  row.start = StartOf(json.at("start"));
  ReadResult(json, row);
  rows_[row.case_name][row.index] = row;
}

void RowFile::Add(int index, const Judgement& judgement) {
  Write(ToJson(index, judgement).dump());
  judgements_[index] = judgement;
}

void RowFile::Add(const Row& row) {
  Write(ToJson(row).dump(-1, ' ', false, Json::error_handler_t::replace));
  rows_[row.case_name][row.index] = row;
}

const std::map<int, Row>& RowFile::rows(const std::string& case_name) const {
  static const std::map<int, Row> kNone;
  const auto rows = rows_.find(case_name);
  return rows == rows_.end() ? kNone : rows->second;
}

void RowFile::Write(const std::string& line) {
  stream_ << line << '\n' << std::flush;
  if (!stream_) {
    throw std::runtime_error(file_.string() + ": cannot be written");
  }
}

}  // namespace fovea::atlas
