// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/sim/shares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/bench/common/scratch.hpp"
#include "tools/bench/common/shell.hpp"

namespace fovea::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Runs `words` and sums its timeline. A run that is too short to converge has not failed.
SpanSums SumsOf(const fs::path& program, const std::string& words, double seconds) {
  const Scratch scratch;
  const fs::path file = scratch.path() / "trace.json";
  const std::string command = fmt::format(
      "{} run {} --set run.duration_s={} --out {} --trace {} >/dev/null 2>&1", Quoted(program.string()),
      words, seconds, Quoted((scratch.path() / "out").string()), Quoted(file.string()));
  RunShell(command);
  return SumSpans(file);
}

}  // namespace

SpanSums SumSpans(const fs::path& file) {
  std::ifstream stream(file);
  const json trace = json::parse(stream, nullptr, /*allow_exceptions=*/false);
  if (!trace.is_object() || !trace.contains("traceEvents")) {
    throw std::runtime_error(file.string() + ": not found, or not a timeline");
  }
  std::map<std::string, double> us;
  std::map<std::string, int> count;
  SpanSums sums;
  for (const json& event : trace["traceEvents"]) {
    if (event.value("ph", "") == "X") {
      const double took = event["dur"];
      us[event["name"]] += took;
      ++count[event["name"]];
      sums.wall_us = std::max(sums.wall_us, event["ts"].get<double>() + took);
    }
  }
  // The span of the world contains the spans of recording and of waiting for a measurement.
  sums.physics_us = us["world"] - us["records"] - us["wait for vision"];
  sums.servo_us = us["tick"];
  sums.render_us = us["draw"] - us["read-back"];
  sums.read_back_us = us["read-back"];
  sums.sensor_us = us["sensor"];
  sums.detection_us = us["detect"];
  sums.logging_us = us["records"] + us["log and film"];
  sums.ticks = count["tick"];
  sums.pictures = count["draw"];
  return sums;
}

std::vector<Figure> SimShares(const fs::path& program, double seconds) {
  const auto sums_of = [&](const char* words) { return SumsOf(program, words, seconds); };
  const SpanSums ball = sums_of("ball");
  std::vector<Figure> figures;
  const auto share = [&](const char* name, double us) {
    figures.push_back({fmt::format("share_{}", name), us / std::max(ball.wall_us, 1e-9), "of wall time", {}});
  };
  share("physics", ball.physics_us);
  share("servo", ball.servo_us);
  share("render", ball.render_us);
  share("read_back", ball.read_back_us);
  share("sensor", ball.sensor_us);
  share("detection", ball.detection_us);
  share("logging", ball.logging_us);

  const auto per_tick = [&](const char* name, const SpanSums& sums) {
    figures.push_back({name, sums.physics_us / std::max(sums.ticks, 1), "us per step", {}});
  };
  const auto per_picture = [&](const char* name, const SpanSums& sums) {
    figures.push_back(
        {name, 1e-3 * (sums.render_us + sums.read_back_us) / std::max(sums.pictures, 1), "ms each", {}});
  };
  per_tick("physics_us_1_joint", sums_of("theory/pd-regulator --no-report"));
  per_tick("physics_us_6_joints",
           sums_of("ball-ur5e --no-report --set camera.enabled=false --set motion.kind=home"));
  per_tick("physics_us_7_joints",
           sums_of("ball --no-report --set camera.enabled=false --set motion.kind=home"));
  per_picture("picture_ms_320x240",
              sums_of("ball --no-report --set camera.width_px=320 --set camera.height_px=240"));
  per_picture("picture_ms_640x480", sums_of("ball --no-report"));
  per_picture("picture_ms_1280x960",
              sums_of("ball --no-report --set camera.width_px=1280 --set camera.height_px=960"));
  per_picture("picture_ms_clutter", sums_of("ball-clutter --no-report"));
  return figures;
}

}  // namespace fovea::bench
