// SPDX-License-Identifier: Apache-2.0
// fovea-soak: hours of robot time in one process, and the findings.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <nlohmann/json.hpp>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/program.hpp"
#include "tests/soak/soak.hpp"

namespace {

using namespace fovea;

// Progress: one overwritten line on a terminal, else a line for every twentieth.
class Progress {
 public:
  void Show(double share) {
    const double spent_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    const bool terminal = isatty(STDERR_FILENO) != 0;
    if (share < next_ || share <= 0.0) {
      return;
    }
    next_ = share + (terminal ? 0.001 : 0.05);
    fmt::print(stderr, "{}{:.0f} %, {:.0f} s, {:.0f} s left{}", terminal ? "\r\x1b[K" : "", 100.0 * share,
               spent_s, spent_s * (1.0 - share) / share, terminal ? "" : "\n");
    std::fflush(stderr);
  }
  void End() {
    if (isatty(STDERR_FILENO) != 0) {
      fmt::print(stderr, "\r\x1b[K");
    }
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double next_ = 0.001;  // earlier the remaining time is unknown
};

std::string Counts(const std::map<std::string, std::uint64_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) {
    if (count > 0) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
    }
  }
  return text.empty() ? "none" : text;
}

void PrintTable(const soak::SoakResult& r) {
  const auto line = [](const char* name, const std::string& what) { fmt::print("  {:<18}{}\n", name, what); };
  line("robot time", fmt::format("{:.3f} h in {:.1f} s, {:.0f} times real time", r.robot_s / 3600.0, r.wall_s,
                                 r.robot_s / r.wall_s));
  line("ticks", fmt::format("{}, {} missed on purpose, {} heap calls in ticks", r.ticks, r.missed_ticks,
                            r.heap_calls));
  line("episodes", Counts(r.endings));
  line("disturbances", Counts(r.troubles));
  line("faults", fmt::format("{}; {} recoveries, {} motions home, {} of them refused", Counts(r.faults),
                             r.recoveries, r.ways_home, r.ways_refused));
  line("memory", fmt::format("grew by {:.0f} KiB resident, {:.1f} KiB in use", r.resident_growth / 1024.0,
                             r.heap_growth / 1024.0));
  for (const soak::DriftFigure& figure : r.drift) {
    line(figure.name.c_str(), fmt::format("{:.4g} in the first tenth, {:.4g} in the last: {:.1f} sigma apart",
                                          figure.first, figure.last, figure.sigmas));
  }
  line("digest", fmt::format("{:016x}", r.digest));
  line("verdict", r.failures.empty() ? "passed" : "FAILED");
  for (const std::string& failure : r.failures) {
    fmt::print("    {}\n", failure);
  }
}

void PrintJson(const soak::SoakOptions& o, const soak::SoakResult& r) {
  nlohmann::json drift = nlohmann::json::object();
  for (const soak::DriftFigure& figure : r.drift) {
    drift[figure.name] = {{"first", figure.first}, {"last", figure.last}, {"sigmas", figure.sigmas}};
  }
  const nlohmann::json json = {
      {"scenario", o.scenario},
      {"seed", o.seed},
      {"camera", o.camera},
      {"late_clock", o.late_clock},
      {"passes", o.passes},
      {"robot_s", r.robot_s},
      {"wall_s", r.wall_s},
      {"ticks", r.ticks},
      {"missed_ticks", r.missed_ticks},
      {"heap_allocations_in_tick", r.heap_calls},
      {"endings", r.endings},
      {"troubles", r.troubles},
      {"faults", r.faults},
      {"recoveries", r.recoveries},
      {"ways_home", r.ways_home},
      {"ways_home_refused", r.ways_refused},
      {"resident_growth_bytes", r.resident_growth},
      {"heap_growth_bytes", r.heap_growth},
      {"drift", drift},
      {"digest", fmt::format("{:016x}", r.digest)},
      {"good", r.failures.empty()},
      {"failures", r.failures},
      {"git", kGitRevision},
  };
  fmt::print("{}\n", json.dump(2));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Soak test: hours of robot time in one process, with random targets, faults and recoveries, run twice. "
      "It fails on a leak, drift, overflow, heap use in a tick, undefined end, or a difference between the "
      "runs."};
  soak::SoakOptions options;
  app.add_option("scenario", options.scenario, "scenario with the arm, camera, kind of target and servo")
      ->capture_default_str();
  app.add_option("--set", options.assignments, "key=value, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option("--hours", options.hours, "hours of robot time")
      ->check(CLI::Range(0.001, 28.0))
      ->capture_default_str();
  app.add_flag("--camera", options.camera,
               "render and detect images; without it, measurements are ground truth with noise");
  app.add_option("--seed", options.seed, "seed of all random numbers")->capture_default_str();
  app.add_flag(
      "--late-clock", options.late_clock,
      "start the clock 30 h before 2^63 ns; counters of ticks, states and frames pass 2^32 half-way");
  app.add_option("--passes", options.passes, "number of identical runs; all must be bit-identical")
      ->check(CLI::Range(1, 10))
      ->capture_default_str();
  bool json = false;
  app.add_flag("--json", json, "print every figure by name");
  app.footer(
      "Examples:\n"
      "  fovea-soak --hours 1\n"
      "  fovea-soak --hours 24 --late-clock --json > soak.json\n"
      "  fovea-soak square --hours 1 --seed 7\n"
      "  fovea-soak --camera --hours 1\n"
      "Exit: 0 passed, 1 failed, 2 wrong usage or input.");
  return config::RunProgram("fovea-soak", app, argc, argv, [&] {
    Progress progress;
    options.progress = [&progress](double share) { progress.Show(share); };
    const soak::SoakResult result = soak::RunSoak(options);
    progress.End();
    if (json) {
      PrintJson(options, result);
    } else {
      PrintTable(result);
    }
    return result.failures.empty() ? config::kDone : config::kGoalMissed;
  });
}
