// SPDX-License-Identifier: Apache-2.0
// fovea-sim: the sim target's command line.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/board_flags.hpp"
#include "firmware/host/config/command_line.hpp"
#include "firmware/host/config/key_text.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "sim/app/run_command.hpp"
#include "sim/app/runs_command.hpp"
#include "sim/app/serve_command.hpp"
#include "sim/calibration/pictures.hpp"
#include "sim/scenario/scenario.hpp"

namespace {

using namespace fovea;

using config::kDone;

struct PictureArguments {
  std::string scenario = "ball";
  std::vector<std::string> assignments;
  config::BoardFlags board;
  int views = 14;
  std::string out = "out/calibration";
};

int TakePictures(const PictureArguments& arguments) {
  sim::CalibrationPicturesOptions options{config::MakeBoard(arguments.board), arguments.views, arguments.out};
  const sim::CalibrationPictures taken =
      sim::TakeCalibrationPictures(sim::LoadScenario(arguments.scenario, arguments.assignments), options);
  const calibration::Board& board = options.board;
  std::string flags = fmt::format("--board {}x{} --square {}", board.columns, board.rows, board.square);
  if (board.HasMarkers()) {
    flags += fmt::format(" --marker {} --dictionary {}", board.marker, board.dictionary);
  }
  config::PrintFitted(
      fmt::format("{0} views of the board in {1}, {2} of a disc in {1}/focal; true values in {1}/truth.json. "
                  "Next:",
                  taken.boards.size(), arguments.out, taken.discs.size()));
  fmt::print(
      "  fovea calibrate intrinsics {1} {3} --out {1}/camera.toml\n"
      "  fovea calibrate hand-eye {1} {3} --camera {1}/camera.toml\n"
      "  fovea calibrate focal --diameter {4} --delta-z {5} {1}/{6} {1}/{7}\n",
      taken.boards.size(), arguments.out, taken.discs.size(), flags, taken.disc_diameter, taken.disc_delta_z,
      taken.discs[0], taken.discs[1]);
  return kDone;
}

void AddPictures(CLI::App& pictures, PictureArguments& arguments) {
  pictures
      .add_option("scenario", arguments.scenario,
                  "scenario with the arm and camera: a shipped name or a .toml")
      ->capture_default_str();
  pictures.add_option("--set", arguments.assignments, "key=value, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  config::AddBoardFlags(pictures, arguments.board);
  pictures.add_option("--views", arguments.views, "number of views of the board")
      ->check(CLI::Range(4, 60))
      ->capture_default_str();
  pictures.add_option("--out", arguments.out, "folder for pictures, poses.csv and truth.json")
      ->capture_default_str();
  pictures.footer(
      "The arm is placed at each view without motion.\n"
      "Example:\n"
      "  fovea-sim pictures --board 8x5 --square 0.03 --marker 0.022 --set camera.lens=[-0.12,0,0,0,0]");
}

int List() {
  const std::vector<std::string> names = sim::ShippedScenarios();
  std::size_t width = 0;
  for (const std::string& name : names) {
    width = std::max(width, name.size());
  }
  for (const std::string& name : names) {
    config::PrintFitted(fmt::format("{:<{}}{}", name, width + 2, sim::LoadScenario(name, {}).run.description),
                        width + 2);
  }
  return kDone;
}

struct KeysArguments {
  bool markdown = false;
  std::string scenario;
  std::vector<std::string> assignments;
};

// The values of a scenario, for programs.
int ValuesOf(const KeysArguments& arguments) {
  sim::Scenario scenario = sim::LoadScenario(arguments.scenario, arguments.assignments);
  const nlohmann::json values(sim::ScenarioKeys(scenario).Values());
  fmt::print("{}\n", values.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  return kDone;
}

void AddKeys(CLI::App& keys, KeysArguments& arguments) {
  CLI::Option* markdown =
      keys.add_flag("--markdown", arguments.markdown, "as the table in sim/scenarios/KEYS.md");
  CLI::Option* values = keys.add_option("--values", arguments.scenario,
                                        "each key's value in a scenario, as JSON: a shipped name or a .toml")
                            ->excludes(markdown);
  keys.add_option("--set", arguments.assignments, "key=value, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->needs(values);
}

int Keys(const KeysArguments& arguments) {
  if (!arguments.scenario.empty()) {
    return ValuesOf(arguments);
  }
  sim::Scenario scenario;
  const config::KeyTable keys = sim::ScenarioKeys(scenario);
  if (arguments.markdown) {
    fmt::print("{}", sim::KeysAsMarkdown(keys));
    return kDone;
  }
  const std::size_t width = config::TerminalWidth(STDOUT_FILENO);
  fmt::print("{}\n{}", config::KeysAsText(keys, width), config::Fitted(sim::TruthFormsAsText(), 15, width));
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Fovea's simulator: an arm in Bullet, a camera rendered by EGL, and the servo that controls them."};
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("fovea-sim {} {}", kVersion, kGitRevision));
  app.footer(
      "Examples:\n"
      "  fovea-sim run ball\n"
      "  fovea-sim run ball --set servo.lambda=3 --seed 7 --out out/fast\n"
      "  fovea-sim run my.toml --pace real --json\n"
      "  fovea-sim run ball --pace real --trace trace.json\n"
      "  fovea-sim run ball --servo mcu --servo-pace timer --instruction-ns 4 --line-jitter-ms 2 "
      "--line-from-s 0.1\n"
      "  fovea-sim serve ball --fci-port 1337\n"
      "  fovea-sim pictures --board 9x6 --square 0.025 --out out/boards\n"
      "Ctrl-C ends a run early and writes all files. A second Ctrl-C ends at once and keeps the log.\n"
      "Exit: 0 the run reached its goal, 1 it did not or was interrupted, 2 wrong usage or input.");

  sim::RunArguments arguments;
  arguments.command = config::CommandLine(argc, argv);
  CLI::App* run = app.add_subcommand("run", "simulate a scenario");
  sim::AddRun(*run, arguments);
  CLI::App* runs = app.add_subcommand("runs", "simulate many runs in one process, as standard input asks");
  runs->footer(sim::kRunsHelp);
  sim::ServeArguments serve_arguments;
  CLI::App* serve =
      app.add_subcommand("serve", "simulate the scenario's Panda as a network robot, until interrupted");
  sim::AddServe(*serve, serve_arguments);
  PictureArguments picture_arguments;
  CLI::App* pictures =
      app.add_subcommand("pictures", "render a calibration board from many views, for `fovea calibrate`");
  AddPictures(*pictures, picture_arguments);
  CLI::App* list = app.add_subcommand("list", "list the shipped scenarios");
  KeysArguments keys_arguments;
  CLI::App* keys = app.add_subcommand("keys", "list every key of a scenario: default, meaning, range, unit");
  AddKeys(*keys, keys_arguments);
  return config::RunProgram("fovea-sim", app, argc, argv, [&] {
    return run->parsed()        ? sim::RunCommand(arguments)
           : runs->parsed()     ? sim::RunsCommand()
           : serve->parsed()    ? sim::ServeCommand(serve_arguments)
           : pictures->parsed() ? TakePictures(picture_arguments)
           : list->parsed()     ? List()
                                : Keys(keys_arguments);
  });
}
