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
  return json;
}

Heading HeadingOf(const nlohmann::json& json) {
  return {json.at("atlas"), json.at("seed"), json.at("set"), json.at("servo")};
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
  json["u_px"] = start.u_px;
  json["v_px"] = start.v_px;
  json["depth"] = start.depth;
  json["tilt_deg"] = start.tilt_deg;
  json["error_px"] = start.error_px;
  json["rejections"] = rejections;
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
  start.u_px = json.at("u_px");
  start.v_px = json.at("v_px");
  start.depth = json.at("depth");
  start.tilt_deg = json.at("tilt_deg");
  start.error_px = json.at("error_px");
  for (std::size_t i = 0; i < start.rejections.size(); ++i) {
    start.rejections[i] = json.at("rejections").at(kRejectionNames[i]);
  }
  return start;
}

Json ToJson(const Row& row) {
  Json json;
  json["run"] = row.index;
  json["start"] = ToJson(row.start);
  json["converged"] = row.converged;
  json["verdict"] = row.verdict;
  json["limit_violations"] = row.limit_violations;
  json["contact_ticks"] = row.contact_ticks;
  json["settle_time_s"] = OrNull(row.settle_time_s);
  json["final_error_px_rms"] = OrNull(row.final_error_px);
  json["final_error_mm"] = OrNull(row.final_error_mm);
  json["final_error_deg"] = OrNull(row.final_error_deg);
  json["limits"] = row.limits;
  json["log_hash"] = row.log_hash;
  return json;
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
  row.limits = json.at("limits").get<std::map<std::string, double>>();
  row.log_hash = json.at("log_hash");
}

}  // namespace

Row MakeRow(int index, const Start& start, const nlohmann::json& summary) {
  constexpr double kSamePx = 0.5;  // angles are written to 0.01 deg
  Row row;
  row.index = index;
  row.start = start;
  ReadResult(summary, row);
  const std::optional<double> seen_px = NumberOrNone(summary.at("start_error_px"));
  if (!seen_px || std::fabs(*seen_px - start.error_px) > kSamePx) {
    throw std::runtime_error(fmt::format(
        "run {}: the target starts {} px from its goal in the simulator, {:.2f} px in the sampler; "
        "arm, camera and servo.goal must be those of the scenario ball",
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
          throw config::InputError(
              fmt::format("{}: rows of another --target, --seed, --set or servo library; omit --resume to "
                          "start again",
                          file_.string()));
        }
      } else {
        Row row;
        row.index = json.at("run");
        row.start = StartOf(json.at("start"));
        ReadResult(json, row);
        rows_[row.index] = row;
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

void RowFile::Add(const Row& row) {
  Write(ToJson(row).dump(-1, ' ', false, Json::error_handler_t::replace));
  rows_[row.index] = row;
}

void RowFile::Write(const std::string& line) {
  stream_ << line << '\n' << std::flush;
  if (!stream_) {
    throw std::runtime_error(file_.string() + ": cannot be written");
  }
}

}  // namespace fovea::atlas
