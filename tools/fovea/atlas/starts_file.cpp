// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/starts_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "tools/fovea/atlas/files.hpp"

namespace fovea::atlas {
namespace {

using config::InputError;
using model::Pose;
using model::VecN;

constexpr double kAngleMost = 360.0;  // [deg]
constexpr double kPlaceMost = 5.0;    // of a target, as target.position allows [m]
constexpr double kSeedMost = 2147483647.0;
constexpr std::array<const char*, 6> kPoseNames{"x", "y", "z", "roll", "pitch", "yaw"};

// A start before it is checked: its values by column.
struct Record {
  int line = 0;
  std::map<std::string, double> values;
};

std::string At(const std::filesystem::path& file, int line) {
  return fmt::format("{}:{}", file.string(), line);
}

std::vector<std::string> PoseColumns(const std::string& of) {
  std::vector<std::string> columns;
  for (const char* name : kPoseNames) {
    columns.push_back(of + "_" + name);
  }
  return columns;
}

std::vector<std::string> PostureColumns(int num_joints) {
  std::vector<std::string> columns;
  for (int i = 1; i <= num_joints; ++i) {
    columns.push_back(fmt::format("q{}", i));
  }
  return columns;
}

// The words between commas, without blanks around them.
std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line + ",");
  for (std::string cell; std::getline(stream, cell, ',');) {
    const std::size_t begin = cell.find_first_not_of(" \t\r");
    const std::size_t end = cell.find_last_not_of(" \t\r");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

std::vector<Record> ReadCsv(const std::filesystem::path& file, const std::string& text) {
  std::vector<Record> records;
  std::vector<std::string> columns;
  std::stringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::vector<std::string> cells = Cells(line);
    if (cells == std::vector<std::string>{""} || cells[0][0] == '#') {
      continue;
    }
    if (columns.empty()) {
      columns = cells;
      continue;
    }
    if (cells.size() != columns.size()) {
      throw InputError(
          fmt::format("{}: {} values for {} columns", At(file, number), cells.size(), columns.size()));
    }
    Record record{number, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = NAN;
      const char* end = cells[i].data() + cells[i].size();
      const auto read = std::from_chars(cells[i].data(), end, value);
      if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) {
        throw InputError(fmt::format("{}: {} = \"{}\" is not allowed: a finite number", At(file, number),
                                     columns[i], cells[i]));
      }
      if (!record.values.emplace(columns[i], value).second) {
        throw InputError(fmt::format("{}: column {} occurs twice", At(file, number), columns[i]));
      }
    }
    records.push_back(record);
  }
  return records;
}

// The line on which each object of the array begins.
std::vector<int> LinesOfObjects(const std::string& text) {
  std::vector<int> lines;
  int line = 1;
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    line += c == '\n' ? 1 : 0;
    in_text = in_text != (c == '"' && text[i - 1] != '\\');
    if (!in_text && c == '{' && depth++ == 0) {
      lines.push_back(line);
    }
    depth -= !in_text && c == '}' ? 1 : 0;
  }
  return lines;
}

std::vector<Record> ReadJson(const std::filesystem::path& file, const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array() ||
      !std::all_of(json.begin(), json.end(), [](const auto& one) { return one.is_object(); })) {
    throw InputError(
        fmt::format("{}: not a JSON array of objects, such as [{{\"q1\": 0.1, ...}}, ...]", At(file, 1)));
  }
  const std::vector<int> lines = LinesOfObjects(text);
  std::vector<Record> records;
  for (std::size_t i = 0; i < json.size(); ++i) {
    Record record{lines[i], {}};
    for (const auto& [name, value] : json[i].items()) {
      if (!value.is_number() || !std::isfinite(value.get<double>())) {
        throw InputError(fmt::format("{}: {} = {} is not allowed: a finite number", At(file, lines[i]), name,
                                     value.dump()));
      }
      record.values[name] = value;
    }
    records.push_back(record);
  }
  return records;
}

// Reads the columns of one record.
class RecordReader {
 public:
  RecordReader(const std::filesystem::path& file, const Record& record)
      : at_(At(file, record.line)), values_(record.values) {}

  // True if there is any of `columns`. InputError: some are there, but not all.
  bool Has(const std::vector<std::string>& columns) {
    std::vector<std::string> missing;
    for (const std::string& column : columns) {
      known_.insert(column);
      if (!values_.contains(column)) {
        missing.push_back(column);
      }
    }
    if (!missing.empty() && missing.size() < columns.size()) {
      Refuse(fmt::format("column {} is missing: allowed are all of {} or none", missing[0],
                         fmt::join(columns, ", ")));
    }
    return missing.empty();
  }

  double Number(const std::string& column, double least, double most, const char* unit) {
    const double value = values_.at(column);
    if (!(value >= least && value <= most)) {
      Refuse(fmt::format("{} = {} is not allowed: {:.6g} to {:.6g}{}", column, value, least, most, unit));
    }
    return value;
  }

  // x, y, z [m] and roll, pitch, yaw [deg].
  std::array<double, 6> PoseOf(const std::string& of) {
    std::array<double, 6> pose{};
    const std::vector<std::string> columns = PoseColumns(of);
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const bool is_place = i < 3;
      const double most = is_place ? kPlaceMost : kAngleMost;
      pose[i] = Number(columns[i], -most, most, is_place ? " m" : " deg");
    }
    return pose;
  }

  void RefuseOthers() const {
    for (const auto& [column, value] : values_) {
      if (!known_.contains(column)) {
        Refuse(
            fmt::format("column {} is not allowed: q1, q2, ... or camera_x, ..., camera_yaw; target_x, ..., "
                        "target_yaw; goal_x, ..., goal_yaw; seed",
                        column));
      }
    }
  }

  [[noreturn]] void Refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: {}", at_, why));
  }

 private:
  const std::string at_;
  const std::map<std::string, double>& values_;
  std::set<std::string> known_;
};

Pose ToPose(const std::array<double, 6>& values) {
  return {config::RollPitchYaw({values[3], values[4], values[5]}), {values[0], values[1], values[2]}};
}

// The posture of q1, q2, ..., within the joints' ranges.
VecN ReadPosture(const model::ArmModel& arm, RecordReader& reader) {
  VecN q(arm.num_joints);
  const std::vector<std::string> columns = PostureColumns(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    q[i] = reader.Number(columns[k], joint.q_min, joint.q_max,
                         joint.type == model::JointType::kPrismatic ? " m" : " rad");
  }
  return q;
}

Start StartOf(const Record& record, const Scene& scene, RecordReader& reader) {
  const model::ArmModel& arm = scene.servo.arm;
  const bool has_posture = reader.Has(PostureColumns(arm.num_joints));
  const bool has_camera = reader.Has(PoseColumns("camera"));
  const bool has_target = reader.Has(PoseColumns("target"));
  const bool has_goal = reader.Has(PoseColumns("goal"));
  const bool has_seed = reader.Has({"seed"});
  reader.RefuseOthers();
  if (has_posture == has_camera) {
    reader.Refuse(fmt::format("needs either q1 to q{} or camera_x to camera_yaw", arm.num_joints));
  }
  if (!has_target) {
    reader.Refuse("column target_x is missing: each start needs target_x to target_yaw");
  }
  Start start;
  start.line = record.line;
  const std::array<double, 6> target = reader.PoseOf("target");
  start.p_BO = {target[0], target[1], target[2]};
  start.rpy_deg = {target[3], target[4], target[5]};
  if (has_goal) {
    const std::array<double, 6> goal = reader.PoseOf("goal");
    start.goal = Goal{{goal[0], goal[1], goal[2]}, {goal[3], goal[4], goal[5]}};
  }
  const double seed = has_seed ? reader.Number("seed", 0.0, kSeedMost, "") : record.line;
  if (seed != std::floor(seed)) {
    reader.Refuse(fmt::format("seed = {} is not allowed: a whole number", seed));
  }
  start.run_seed = static_cast<std::uint32_t>(seed);
  start.way_seed = start.run_seed;
  const Sampler sampler(start.goal ? WithGoal(scene, *start.goal) : scene);
  const StartChecks& checks = sampler.goals().checks();
  const Pose X_BO = start.TargetPose();
  const auto refusal_at = [&](const VecN& q) { return sampler.Refusal(checks.At(q), X_BO); };
  std::optional<VecN> q;
  if (has_posture) {
    q = ReadPosture(arm, reader);
    if (const std::optional<Rejection> refusal = refusal_at(*q)) {
      reader.Refuse(
          fmt::format("no run can begin there: {}", kRejectionWords.at(static_cast<std::size_t>(*refusal))));
    }
  } else {
    q = sampler.goals().WithCameraAt(ToPose(reader.PoseOf("camera")),
                                     [&](const VecN& at) { return !refusal_at(at); });
    if (!q) {
      reader.Refuse(
          "camera_x to camera_yaw: no posture of the arm found that has the camera there, within the joints' "
          "ranges, clear of everything and with the target in sight");
    }
  }
  start.q.assign(q->begin(), q->end());
  sampler.Describe(start);
  return start;
}

}  // namespace

std::vector<Start> ReadStarts(const std::filesystem::path& file, const Scene& scene) {
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(fmt::format("--starts {}: cannot be read", file.string()));
  }
  const std::string text = Content(file);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_json = first != std::string::npos && (text[first] == '[' || text[first] == '{');
  const std::vector<Record> records = is_json ? ReadJson(file, text) : ReadCsv(file, text);
  if (records.empty()) {
    throw InputError(fmt::format("{}: contains no start", file.string()));
  }
  std::vector<Start> starts;
  for (const Record& record : records) {
    RecordReader reader(file, record);
    starts.push_back(StartOf(record, scene, reader));
  }
  return starts;
}

// FNV-1a, 64 bits.
std::string HashOfFile(const std::filesystem::path& file) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : Content(file)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace fovea::atlas
