// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/compare.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/output_folder.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "tools/fovea/compare/page.hpp"
#include "tools/fovea/compare/text.hpp"

namespace fovea {
namespace {

const std::string kPage = "compare.html";
const std::string kFigures = "compare.json";

}  // namespace

const CLI::App* AddCompare(CLI::App& app, CompareArguments& arguments) {
  CLI::App* compare = app.add_subcommand(
      "compare", "play a log's commands into the simulator's arm: where, and why, the recorded arm differs");
  compare->add_option("log", arguments.log, "a log.mcap, or the folder of a run: simulated, or of fovea-hw")
      ->required();
  compare->add_option(
      "--scenario", arguments.scenario,
      "the arm of this scenario, a name or a .toml, instead of that of the log's configuration");
  compare
      ->add_option("--set", arguments.settings, "key=value of [arm]: compare with an arm that has this value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  compare
      ->add_option("--window-ms", arguments.window_ms,
                   "the simulated arm starts anew from the recorded state after this time; even")
      ->check(CLI::Range(20, 1000))
      ->capture_default_str();
  compare->add_option("--out", arguments.out, "a folder for compare.html and compare.json");
  compare->add_flag("--json", arguments.json, "print JSON");
  compare->footer(
      "Examples:\n"
      "  fovea compare out/ball\n"
      "  fovea compare out/ball --set arm.load_mass=0.5 --out out/ball-compared\n"
      "  fovea compare out/ball --scenario ball --set arm.realism=panda --json\n"
      "Exit: 0 compared, whether they differ or not; 2 wrong usage or input.");
  return compare;
}

int Compare(const CompareArguments& arguments) {
  if (arguments.window_ms % 2 != 0) {
    throw config::InputError(
        fmt::format("--window-ms {} is not allowed: it must be even", arguments.window_ms));
  }
  const std::filesystem::path log = flight::LogIn(arguments.log);
  const compare::RecordedRun run = compare::ReadRun(log);
  std::optional<config::OutputFolder> out;
  if (!arguments.out.empty()) {
    out.emplace(arguments.out);
  }
  const compare::SimulatedArm arm = [&] {
    try {
      return compare::MakeSimulatedArm(run, arguments.scenario, arguments.settings);
    } catch (const config::InputError& error) {
      throw config::InputError(log.string() + ": " + error.what());
    }
  }();
  const compare::Comparison comparison = compare::Compare(log, run, arm, arguments.window_ms);
  const std::string figures = compare::ToJson(log.string(), comparison, arguments.settings);
  if (arguments.json) {
    fmt::print("{}", figures);
  } else {
    config::PrintFitted(compare::ToText(log.string(), comparison), 4);
  }
  if (out) {
    out->Replace({{kFigures, figures}, {kPage, compare::MakePage(log.string(), comparison, figures)}},
                 {kFigures, kPage});
    if (!arguments.json) {
      fmt::print("{}\n", (out->path() / kPage).string());
    }
  }
  return config::kDone;
}

}  // namespace fovea
