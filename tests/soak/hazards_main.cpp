// SPDX-License-Identifier: Apache-2.0
// fovea-hazards: thousands of random cases of each hazard, with the worst motion of the arm.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "firmware/host/config/program.hpp"
#include "tests/closed_loop/hazards.hpp"

namespace {

using namespace fovea;

constexpr const char* kHead =
    "| hazard | detected, of all | delay, 99 %; max | hand displacement, median; 99 %; max | fastest hand | "
    "at rest at the end | contacts; joint too fast | fastest joint, of its limit |\n"
    "|---|---|---|---|---|---|---|---|\n";

std::string RowOf(const test::Hazard& hazard, const test::HazardFigures& f) {
  return fmt::format(
      "| {} | {} of {} | {} ms; {} ms | {:.1f} mm; {:.0f} mm; {:.0f} mm (seed {}) | {:.2f} m/s | {} | {}; {} "
      "| {:.0f} % (seed {}) |\n",
      hazard.what, f.noticed, f.cases, f.noticed_p99_ms, f.noticed_most_ms, f.way_p50_mm, f.way_p99_mm,
      f.way_most_mm, f.worst_seed, f.speed_most, f.stand, f.touched, f.passed, 100.0 * f.joint_most,
      f.joint_seed);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Fovea: hazards in random cases, the arm in physics, judged by the simulator's truth."};
  int cases = 200;
  int jobs = 1;
  std::uint64_t seed = 1;
  std::vector<std::string> only;
  app.add_option("--cases", cases, "number of cases per hazard")->check(CLI::Range(1, 1'000'000));
  app.add_option("--jobs", jobs, "threads; no figure depends on them")->check(CLI::Range(1, 64));
  app.add_option("--seed", seed, "seed of the first case");
  app.add_option("--only", only, "hazards by name");
  app.footer(
      "Example:\n  fovea-hazards --cases 10000 --jobs 2\nExit: 1 when the arm touched something or a joint "
      "was too fast.");
  return config::RunProgram("fovea-hazards", app, argc, argv, [&] {
    bool sound = true;
    fmt::print("{}", kHead);
    for (const test::Hazard& hazard : test::Hazards()) {
      if (!only.empty() && std::find(only.begin(), only.end(), hazard.name) == only.end()) {
        continue;
      }
      double next = 0.1;
      const test::HazardFigures figures = test::RunCases(hazard, cases, jobs, seed, [&](double share) {
        if (share >= next) {
          fmt::print(stderr, "{}: {:.0f} %\n", hazard.name, 100.0 * share);
          next += 0.1;
        }
      });
      fmt::print("{}", RowOf(hazard, figures));
      std::fflush(stdout);
      sound = sound && figures.touched == 0 && figures.passed == 0;
    }
    return sound ? config::kDone : config::kGoalMissed;
  });
}
