// fovea-sim: the sim target's command line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "fovea/build_info.hpp"
#include "fovea/config/program.hpp"
#include "sim/app/run.hpp"
#include "sim/app/scenario.hpp"

namespace {

using namespace fovea;

using config::kDone;
using config::kGoalMissed;

struct RunArguments {
  std::string scenario;
  std::vector<std::string> assignments;
  int seed = -1;
  std::string pace = "lockstep";
  std::string out;
  bool no_report = false;
  bool json = false;
};

int Run(const RunArguments& arguments) {
  std::vector<std::string> assignments = arguments.assignments;
  if (arguments.seed >= 0) {
    assignments.push_back(fmt::format("run.seed={}", arguments.seed));
  }
  const sim::Scenario scenario = sim::LoadScenario(arguments.scenario, assignments);
  sim::RunOptions options;
  options.pace = arguments.pace == "real" ? sim::Pace::kReal : sim::Pace::kLockstep;
  options.out = arguments.out.empty() ? "out/" + scenario.name : arguments.out;
  options.report = !arguments.no_report;
  const sim::Summary summary = sim::RunScenario(scenario, options);
  if (arguments.json) {
    fmt::print("{}", sim::ToJson(summary));
  } else {
    fmt::print("{}  {:<24}{}\n", sim::ToTable(summary), "files", options.out.string());
    if (options.report) {
      fmt::print("  {:<24}{}\n", "report", (options.out / "report.html").string());
    }
  }
  return sim::ReachedItsGoal(summary) ? kDone : kGoalMissed;
}

int List() {
  const std::vector<std::string> names = sim::ShippedScenarios();
  std::size_t width = 0;
  for (const std::string& name : names) {
    width = std::max(width, name.size());
  }
  for (const std::string& name : names) {
    fmt::print("{:<{}}{}\n", name, width + 2, sim::LoadScenario(name, {}).run.description);
  }
  return kDone;
}

int Keys(bool markdown) {
  sim::Scenario scenario;
  const config::KeyTable keys = sim::ScenarioKeys(scenario);
  if (markdown) {
    fmt::print("{}", sim::KeysAsMarkdown(keys));
    return kDone;
  }
  for (const config::Key& key : keys.keys()) {
    fmt::print("{} = {}\n    {}; {}: {}{}{}\n", key.name, key.default_text, key.meaning, key.kind,
               key.allowed, key.unit.empty() ? "" : " ", key.unit);
  }
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Fovea's simulator: a Bullet arm, an EGL camera in its hand, and the servo that steers it."};
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("fovea-sim {} {}", kVersion, kGitRevision));
  app.footer(
      "Examples:\n"
      "  fovea-sim run ball\n"
      "  fovea-sim run ball --set servo.lambda=3 --seed 7 --out out/fast\n"
      "  fovea-sim run my.toml --pace real --json\n"
      "Exit: 0 the run reached its goal, 1 it did not, 2 wrong usage or input.");

  RunArguments arguments;
  CLI::App* run = app.add_subcommand("run", "simulate a scenario");
  run->add_option("scenario", arguments.scenario, "a shipped scenario by name, or the path of a .toml")
      ->required();
  run->add_option("--set", arguments.assignments, "key=value, over the scenario's own; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  run->add_option("--seed", arguments.seed, "of all that is random")->check(CLI::Range(0, 2147483647));
  run->add_option("--pace", arguments.pace,
                  "lockstep: as fast as it goes, repeatable; real: 1 ms by the clock")
      ->check(CLI::IsMember({"lockstep", "real"}));
  run->add_option("--out", arguments.out, "folder for the files; out/<scenario> when not given");
  run->add_flag("--no-report", arguments.no_report, "leave out what takes long to draw");
  run->add_flag("--json", arguments.json, "print summary.json instead of the table");
  CLI::App* list = app.add_subcommand("list", "shipped scenarios, one line each");
  bool markdown = false;
  CLI::App* keys = app.add_subcommand("keys", "every key of a scenario: default, meaning, range, unit");
  keys->add_flag("--markdown", markdown, "as the table in sim/scenarios/KEYS.md");

  return config::RunProgram("fovea-sim", app, argc, argv, [&] {
    return run->parsed() ? Run(arguments) : list->parsed() ? List() : Keys(markdown);
  });
}
