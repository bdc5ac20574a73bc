// SPDX-License-Identifier: Apache-2.0
// fovea-sim: the sim target's command line.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <stdexcept>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/board_flags.hpp"
#include "firmware/host/config/command_line.hpp"
#include "firmware/host/config/key_text.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "fovea/linux_rt/interrupt.hpp"
#include "fovea/linux_rt/speaker.hpp"
#include "sim/app/run.hpp"
#include "sim/app/serve.hpp"
#include "sim/calibration/pictures.hpp"
#include "sim/scenario/scenario.hpp"

namespace {

using namespace fovea;

using config::kDone;
using config::kGoalMissed;

struct RunArguments {
  std::string scenario;
  std::vector<std::string> assignments;
  int seed = -1;
  std::string pace = "lockstep";
  std::string servo = "pc";
  std::string servo_image;
  std::string servo_pace = "lockstep";
  sim::BoardConfig board;
  std::vector<const CLI::Option*> of_board;  // require --servo mcu
  std::vector<const CLI::Option*> of_timer;  // require --servo-pace timer
  std::string out;
  std::string trace;
  bool no_report = false;
  bool json = false;
  std::string command;  // the command line as typed
};

// Throws InputError if one of `options` is given: they require `choice`.
void RefuseGiven(const std::vector<const CLI::Option*>& options, const std::string& choice) {
  for (const CLI::Option* option : options) {
    if (option->count() > 0) {
      throw config::InputError(fmt::format("{} requires {}", option->get_name(), choice));
    }
  }
}

sim::BoardConfig MakeBoard(const RunArguments& arguments, const sim::Scenario& scenario) {
  sim::BoardConfig board = arguments.board;
  board.by_timer = arguments.servo_pace == "timer";
  if (arguments.servo != "mcu") {
    RefuseGiven(arguments.of_board, "--servo mcu");
  }
  if (!board.by_timer) {
    RefuseGiven(arguments.of_timer, "--servo-pace timer");
  }
  if (board.by_timer && scenario.faults.stall.window.Begins()) {
    throw config::InputError(
        "faults.deadline_miss_s is not allowed with --servo-pace timer: the board itself times the ticks; "
        "for missed ticks use a slower board (--instruction-ns)");
  }
  return board;
}

int Run(const RunArguments& arguments) {
  std::signal(SIGPIPE, SIG_IGN);  // nobody reads the progress any more: the run goes on
  linux_rt::Interrupt interrupt;  // from here on, Ctrl-C ends the run early and writes all files
  std::vector<std::string> assignments = arguments.assignments;
  if (arguments.seed >= 0) {
    assignments.push_back(fmt::format("run.seed={}", arguments.seed));
  }
  const sim::Scenario scenario = sim::LoadScenario(arguments.scenario, assignments);
  sim::RunOptions options;
  options.pace = arguments.pace == "real" ? sim::Pace::kReal : sim::Pace::kLockstep;
  if (arguments.servo == "mcu") {
    if (options.pace == sim::Pace::kReal) {
      throw config::InputError("--servo mcu requires --pace lockstep");
    }
    options.servo_image = arguments.servo_image.empty() ? config::ShareFolder() / "fovea-mcu.elf"
                                                        : std::filesystem::path(arguments.servo_image);
  }
  options.board = MakeBoard(arguments, scenario);
  options.out = arguments.out.empty() ? "out/" + scenario.name : arguments.out;
  options.report = !arguments.no_report;
  options.trace = arguments.trace;
  options.command = arguments.command;
  options.interrupt = &interrupt;
  const sim::Summary summary = sim::RunScenario(scenario, options);
  for (const std::string& error : summary.film_errors) {
    config::PrintError("fovea-sim", error);
  }
  if (arguments.json) {
    fmt::print("{}", sim::ToJson(summary));
  } else {
    const config::TextStyle style = config::StyleOf(STDOUT_FILENO);
    config::PrintedTable files(style);
    if (summary.files_error.empty()) {
      files.WholeRow("files", options.out.string());
    }
    if (summary.files_error.empty() && options.report) {
      files.WholeRow("report", (options.out / "report.html").string());
    }
    fmt::print("{}{}", sim::ToTable(summary, style), files.text());
  }
  if (!summary.files_error.empty()) {
    throw config::InputError(summary.files_error);
  }
  return sim::ReachedItsGoal(summary) ? kDone : kGoalMissed;
}

void AddBoard(CLI::App& run, RunArguments& arguments) {
  run.add_option("--servo", arguments.servo,
                 "pc: the servo runs in this program; mcu: on a Cortex-M7 in QEMU")
      ->check(CLI::IsMember({"pc", "mcu"}));
  arguments.of_board = {
      run.add_option("--servo-image", arguments.servo_image,
                     "with --servo mcu: the image file; default: the shipped one")
          ->check(CLI::ExistingFile),
      run.add_option("--servo-pace", arguments.servo_pace,
                     "with --servo mcu. lockstep: one tick per state; timer: ticks at the board's own 1 kHz "
                     "in virtual time, with or without a new state")
          ->check(CLI::IsMember({"lockstep", "timer"})),
      run.add_option("--instruction-ns", arguments.board.instruction_ns,
                     "with --servo mcu: time of one instruction [ns]; a slow processor misses ticks")
          ->check(CLI::IsMember({1, 2, 4, 8, 16, 32, 64}))
          ->capture_default_str()};
  sim::LinkFaults& line = arguments.board.line;
  arguments.of_timer = {
      run.add_option("--line-loss", line.loss, "with --servo-pace timer: share of lost states and torques")
          ->check(CLI::Range(0.0, 1.0))
          ->capture_default_str(),
      run.add_option("--line-delay-ms", line.delay_ms, "delay of every state and torque [ms]")
          ->check(CLI::Range(0.0, 1000.0))
          ->capture_default_str(),
      run.add_option("--line-jitter-ms", line.jitter_ms,
                     "largest additional random delay [ms], by the run's seed")
          ->check(CLI::Range(0.0, 1000.0))
          ->capture_default_str(),
      run.add_option("--line-from-s", arguments.board.line_from_s,
                     "time from which the line has faults [s]; before, it is perfect")
          ->check(CLI::NonNegativeNumber)
          ->capture_default_str()};
}

struct ServeArguments {
  std::string scenario;
  std::vector<std::string> assignments;
  int seed = -1;
  std::string pace = "real";
  bool json = false;
  std::vector<std::string> walls;
  sim::ServeOptions options;
};

int Serve(const ServeArguments& arguments) {
  std::vector<std::string> assignments = arguments.assignments;
  if (arguments.seed >= 0) {
    assignments.push_back(fmt::format("run.seed={}", arguments.seed));
  }
  sim::ServeOptions options = arguments.options;
  options.server.lockstep = arguments.pace == "lockstep";
  for (const std::string& wall : arguments.walls) {
    options.walls.push_back(sim::ParseWall(wall));
  }
  const sim::Scenario scenario = sim::LoadScenario(arguments.scenario, assignments);
  std::signal(SIGPIPE, SIG_IGN);
  linux_rt::Speaker speaker(STDERR_FILENO);
  const sim::ServeSummary summary =
      sim::Serve(scenario, options, [&](const std::string& line) { speaker.Say(line); });
  if (arguments.json) {
    fmt::print("{}", sim::ToJson(summary));
  } else {
    const sim::FciServerCounters& c = summary.robot;
    config::PrintFitted(fmt::format(
        "{} states, {} commands applied, {} missing, {} overruns, {} ms skipped; {} frames, {} dropped",
        c.states, c.commands, c.missing, c.overruns, c.given_up_ns / hal::kNsPerMs, summary.frames_sent,
        summary.frames_dropped));
    if (summary.error_px) {
      fmt::print("final target error: {:.2f} px, {:.2f} mm\n", *summary.error_px, *summary.error_mm);
    }
  }
  if (!summary.error.empty()) {
    throw std::runtime_error(summary.error);
  }
  return kDone;
}

void AddServe(CLI::App& serve, ServeArguments& arguments) {
  sim::FciServerConfig& server = arguments.options.server;
  serve.add_option("scenario", arguments.scenario, "a shipped scenario by name, or the path of a .toml")
      ->required();
  serve.add_option("--set", arguments.assignments, "key=value, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  serve.add_option("--seed", arguments.seed, "seed of all random numbers")->check(CLI::Range(0, 2147483647));
  serve
      .add_option("--pace", arguments.pace,
                  "real: 1 ms by the clock; lockstep: the robot waits for its client")
      ->check(CLI::IsMember({"lockstep", "real"}));
  serve
      .add_option("--most-speed", server.most_speed,
                  "largest speed of the robot's time relative to the clock, for busy machines; 0: no limit "
                  "in lockstep, 1 at real pace")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  serve.add_option("--fci-port", server.at.port, "TCP port; 0: take a free port and print it")
      ->capture_default_str();
  serve.add_option("--address", arguments.options.address, "address to listen on; 0.0.0.0: all networks")
      ->capture_default_str();
  serve
      .add_option("--camera-serial", arguments.options.camera_serial,
                  "serial number of the GigE Vision camera; \"\": no camera")
      ->capture_default_str();
  serve
      .add_option(
          "--wall", arguments.walls,
          "X,Y,Z,DX,DY,DZ: a forbidden cuboid for the end effector: corner and edges [m]; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  serve.add_option("--late-ms", server.late_ms, "largest age of the state that a command answers [ms]")
      ->check(CLI::Range(0, 19))
      ->capture_default_str();
  const auto share = [&](const char* name, double& value, const char* what) {
    serve.add_option(name, value, what)->check(CLI::Range(0.0, 1.0))->capture_default_str();
  };
  share("--loss", server.faults.loss, "share of lost datagrams");
  share("--duplicate", server.faults.duplicate, "share of duplicated datagrams");
  share("--reorder", server.faults.reorder, "share of reordered datagrams");
  serve
      .add_option("--delay-ms", server.faults.delay_ms,
                  "delay of every datagram [ms]; in lockstep only of commands")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  serve.add_option("--jitter-ms", server.faults.jitter_ms, "largest additional random delay [ms]")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  serve.add_option("--out", arguments.options.out, "folder for summary.json; without it, write no file");
  serve.add_flag("--json", arguments.json, "print summary.json at the end");
  serve.footer(
      "Type one command per line: s presses or releases the stop button; g presses or releases the enabling\n"
      "button for hand guiding; f X Y Z pulls the hand with this force [N]; h freezes the robot: it repeats\n"
      "one state.\n"
      "Examples:\n"
      "  fovea-sim serve ball --fci-port 1337\n"
      "  fovea-sim serve ball --pace lockstep --loss 0.05 --jitter-ms 2 --late-ms 3\n"
      "  fovea-sim serve ball --wall 0.1,0.2,0,0.6,0.5,0.8");
}

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

int Keys(bool markdown) {
  sim::Scenario scenario;
  const config::KeyTable keys = sim::ScenarioKeys(scenario);
  fmt::print("{}", markdown ? sim::KeysAsMarkdown(keys)
                            : config::KeysAsText(keys, config::TerminalWidth(STDOUT_FILENO)));
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

  RunArguments arguments;
  arguments.command = config::CommandLine(argc, argv);
  CLI::App* run = app.add_subcommand("run", "simulate a scenario");
  run->add_option("scenario", arguments.scenario, "a shipped scenario by name, or the path of a .toml")
      ->required();
  run->add_option("--set", arguments.assignments, "key=value, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  run->add_option("--seed", arguments.seed, "seed of all random numbers")->check(CLI::Range(0, 2147483647));
  run->add_option("--pace", arguments.pace,
                  "lockstep: as fast as possible, repeatable; real: 1 ms by the clock")
      ->check(CLI::IsMember({"lockstep", "real"}));
  AddBoard(*run, arguments);
  run->add_option("--out", arguments.out, "folder for the files; default: out/<scenario>");
  run->add_option("--trace", arguments.trace,
                  "write a timeline of all threads for ui.perfetto.dev or chrome://tracing");
  run->add_flag("--no-report", arguments.no_report, "write no report and no pictures");
  run->add_flag("--json", arguments.json, "print summary.json instead of the table");
  ServeArguments serve_arguments;
  CLI::App* serve =
      app.add_subcommand("serve", "simulate the scenario's Panda as a network robot, until interrupted");
  AddServe(*serve, serve_arguments);
  PictureArguments picture_arguments;
  CLI::App* pictures =
      app.add_subcommand("pictures", "render a calibration board from many views, for `fovea calibrate`");
  AddPictures(*pictures, picture_arguments);
  CLI::App* list = app.add_subcommand("list", "list the shipped scenarios");
  bool markdown = false;
  CLI::App* keys = app.add_subcommand("keys", "list every key of a scenario: default, meaning, range, unit");
  keys->add_flag("--markdown", markdown, "as the table in sim/scenarios/KEYS.md");
  return config::RunProgram("fovea-sim", app, argc, argv, [&] {
    return run->parsed()        ? Run(arguments)
           : serve->parsed()    ? Serve(serve_arguments)
           : pictures->parsed() ? TakePictures(picture_arguments)
           : list->parsed()     ? List()
                                : Keys(markdown);
  });
}
