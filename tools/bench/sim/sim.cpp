// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/sim/sim.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/config/program.hpp"
#include "tools/bench/common/figure.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/bench/sim/shares.hpp"

namespace fovea::bench {
namespace {

using nlohmann::json;

struct Setting {
  std::string name;  // of its figure
  std::string keys;  // for --set
  bool one_core = false;
  std::optional<double> goal;
};

std::vector<Setting> Settings() {
  std::vector<Setting> settings{
      {"rtf_no_camera", "--set camera.enabled=false --set motion.kind=home", false, 100.0}};
  for (const auto& [width, height] : {std::pair{320, 240}, {640, 480}, {1280, 720}}) {
    for (const int rate : {30, 60}) {
      for (const bool one_core : {false, true}) {
        const std::string name = fmt::format("rtf_{}x{}_{}{}", width, height, rate, one_core ? "_1core" : "");
        const bool is_reference = name == "rtf_640x480_30";
        settings.push_back(
            {name,
             fmt::format("--set camera.width_px={} --set camera.height_px={} --set camera.rate_hz={}", width,
                         height, rate),
             one_core, is_reference ? std::optional<double>(10.0) : std::nullopt});
      }
    }
  }
  return settings;
}

std::string Command(const std::filesystem::path& program, const Setting& setting, double seconds) {
  return fmt::format("{}{} run ball --no-report --json --set run.duration_s={} {} 2>/dev/null",
                     setting.one_core ? "taskset -c 0 " : "", Quoted(program.string()), seconds,
                     setting.keys);
}

// The summary that `fovea-sim run ball --json` prints.
json Summary(const std::filesystem::path& program, const Setting& setting, double seconds) {
  const std::string command = Command(program, setting, seconds);
  // A run that is too short to converge has not failed. Its output counts, not its exit code.
  const json summary = json::parse(RunShell(command).output, nullptr, /*allow_exceptions=*/false);
  if (!summary.is_object() || !summary.contains("real_time_factor")) {
    throw std::runtime_error(setting.name + ": the simulator did not run: " + command);
  }
  return summary;
}

// Processor time on all cores of the child programs that have ended [s].
double ProcessorTime() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Processor time that a simulated second takes [s], without start-up: a run of twice `seconds` minus a run of
// `seconds`, the least of kTries each. Other programs on the machine disturb it less than wall time.
double ProcessorShare(const std::filesystem::path& program, const Setting& setting, double seconds) {
  constexpr int kTries = 3;
  double shortest[2] = {HUGE_VAL, HUGE_VAL};
  for (int k = 0; k < 2 * kTries; ++k) {
    const double begin = ProcessorTime();
    Summary(program, setting, k % 2 == 0 ? seconds : 2.0 * seconds);
    shortest[k % 2] = std::min(shortest[k % 2], ProcessorTime() - begin);
  }
  return (shortest[1] - shortest[0]) / seconds;
}

// Processor time of a physics step and of a picture. The goals: without a camera, a simulated second takes
// 1/100 s of one core; with a camera, 1/10 s of two cores.
std::vector<Figure> ProcessorShares(const std::filesystem::path& program, const Setting& no_camera,
                                    double seconds) {
  constexpr double kStepsPerSecond = 1000.0;
  constexpr double kPicturesPerSecond = 30.0;
  const Setting reference{"", "", false, {}};
  // Longer runs, because a simulated second without a camera takes very little time.
  const double step = ProcessorShare(program, no_camera, 10.0 * seconds) / kStepsPerSecond;
  const double picture = ProcessorShare(program, reference, seconds) / kPicturesPerSecond;
  return {{"step_no_camera_cpu_us", 1e6 * step, "us", 1e6 / 100.0 / kStepsPerSecond},
          {"picture_cpu_ms", 1e3 * picture, "ms", 1e3 * 2.0 / 10.0 / kPicturesPerSecond}};
}

}  // namespace

int RunSim(const SimArguments& arguments) {
  const std::filesystem::path program = SimulatorBeside("fovea-bench sim");
  std::vector<Figure> figures = SimShares(program, arguments.seconds);
  if (arguments.shares) {
    fmt::print("{}", arguments.json ? ToJson(figures) + "\n" : ToTable(figures));
    return config::kDone;
  }
  const std::vector<Setting> settings = Settings();
  const std::vector<Figure> shares = ProcessorShares(program, settings.front(), arguments.seconds);
  figures.insert(figures.end(), shares.begin(), shares.end());
  for (std::size_t i = 0; i < settings.size(); ++i) {
    if (isatty(STDERR_FILENO) != 0) {
      fmt::print(stderr, "\r\x1b[K{} of {}: {} ...", i + 1, settings.size(), settings[i].name);
      std::fflush(stderr);
    }
    const json summary = Summary(program, settings[i], arguments.seconds);
    figures.push_back({settings[i].name, summary["real_time_factor"], "times real time", settings[i].goal});
  }
  if (isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r\x1b[K");
  }
  fmt::print("{}", arguments.json ? ToJson(figures) + "\n" : ToTable(figures));
  return config::kDone;
}

}  // namespace fovea::bench
