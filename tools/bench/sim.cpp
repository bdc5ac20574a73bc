#include "sim.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "figure.hpp"
#include "fovea/config/program.hpp"
#include "shell.hpp"
#include "sim_shares.hpp"

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

// What `fovea-sim run ball --json` says, run as a program of its own.
json Summary(const std::filesystem::path& program, const Setting& setting, double seconds) {
  const std::string command =
      fmt::format("{}{} run ball --no-report --json --set run.duration_s={} {} 2>/dev/null",
                  setting.one_core ? "taskset -c 0 " : "", Quoted(program.string()), seconds, setting.keys);
  // A run too short to converge is none that failed: what it printed counts.
  const json summary = json::parse(RunShell(command).output, nullptr, /*allow_exceptions=*/false);
  if (!summary.is_object() || !summary.contains("real_time_factor")) {
    throw std::runtime_error(setting.name + ": the simulator did not run: " + command);
  }
  return summary;
}

}  // namespace

int RunSim(const SimArguments& arguments) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "fovea-sim";
  if (!std::filesystem::is_regular_file(program)) {
    throw std::runtime_error(program.string() +
                             ": not there; fovea-bench sim needs the simulator built beside it");
  }
  std::vector<Figure> figures = SimShares(program, arguments.seconds);
  if (arguments.shares) {
    fmt::print("{}", arguments.json ? ToJson(figures) + "\n" : ToTable(figures));
    return config::kDone;
  }
  const std::vector<Setting> settings = Settings();
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
