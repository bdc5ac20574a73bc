// SPDX-License-Identifier: Apache-2.0
#include "sim/app/run_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <filesystem>
#include <optional>
#include <utility>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "fovea/linux_rt/interrupt.hpp"
#include "sim/app/opened_page.hpp"
#include "sim/app/run.hpp"
#include "sim/operator/live_page.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/scenario.hpp"

namespace fovea::sim {
namespace {

// Throws InputError if one of `options` is given: they require `choice`.
void RefuseGiven(const std::vector<const CLI::Option*>& options, const std::string& choice) {
  for (const CLI::Option* option : options) {
    if (option->count() > 0) {
      throw config::InputError(fmt::format("{} requires {}", option->get_name(), choice));
    }
  }
}

BoardConfig MakeBoard(const RunArguments& arguments, const Scenario& scenario) {
  BoardConfig board = arguments.board;
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
  LinkFaults& line = arguments.board.line;
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

void PrintResult(const Summary& summary, const RunOptions& options, bool json) {
  for (const std::string& error : summary.film_errors) {
    config::PrintError("fovea-sim", error);
  }
  if (json) {
    fmt::print("{}", ToJson(summary));
  } else {
    const config::TextStyle style = config::StyleOf(STDOUT_FILENO);
    config::PrintedTable files(style);
    if (summary.files_error.empty()) {
      files.WholeRow("files", options.out.string());
    }
    if (summary.files_error.empty() && options.report) {
      files.WholeRow("report", (options.out / "report.html").string());
    }
    fmt::print("{}{}", ToTable(summary, style), files.text());
  }
  if (!summary.files_error.empty()) {
    throw config::InputError(summary.files_error);
  }
}

void CheckLive(const RunArguments& arguments) {
  const auto refuse = [](const std::string& option) {
    throw config::InputError(option + " is not allowed with --live");
  };
  if (arguments.pace == "real") {
    throw config::InputError(
        "--pace real is not allowed with --live, whose virtual time keeps to the clock by itself");
  }
  if (arguments.servo != "pc") {
    refuse("--servo mcu");
  }
  if (!arguments.trace.empty()) {
    refuse("--trace");
  }
  if (arguments.no_report) {
    refuse("--no-report");
  }
}

// Runs the scenario until its operator ends it. Each reset begins a new run, with its own folder.
int RunLive(const Scenario& scenario, RunOptions options, const RunArguments& arguments) {
  CheckLive(arguments);
  live::ServerConfig config;
  config.address = arguments.page.address;
  config.port = static_cast<std::uint16_t>(arguments.page.port);
  config.allowed_origins = arguments.page.origins;
  LivePage page(std::move(config), DescribeRun(scenario));
  fmt::print(stderr, "live at {}\n", page.server().url());
  std::optional<OpenedPage> opened;
  if (arguments.page.open) {
    opened.emplace(page.server().url());
  }
  options.live = &page;
  options.show_progress = false;
  const std::string first_out = options.out.string();
  int run = 1;
  std::uint64_t violations = 0;  // of all runs
  do {
    options.out = run == 1 ? first_out : fmt::format("{}-{}", first_out, run);
    const Summary summary = RunScenario(scenario, options);
    violations += summary.limit_violations;
    PrintResult(summary, options, arguments.json);
    ++run;
  } while (page.resets() && !options.interrupt->Came());
  return violations == 0 ? config::kDone : config::kGoalMissed;
}

}  // namespace

void AddRun(CLI::App& run, RunArguments& arguments) {
  run.add_option("scenario", arguments.scenario, "a shipped scenario by name, or the path of a .toml")
      ->required();
  run.add_option("--set", arguments.assignments, "key=value, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  run.add_option("--seed", arguments.seed, "seed of all random numbers")->check(CLI::Range(0, 2147483647));
  run.add_option("--pace", arguments.pace,
                 "lockstep: as fast as possible, repeatable; real: 1 ms by the clock")
      ->check(CLI::IsMember({"lockstep", "real"}));
  AddBoard(run, arguments);
  run.add_option("--out", arguments.out, "folder for the files; default: out/<scenario>");
  run.add_option("--trace", arguments.trace,
                 "write a timeline of all threads for ui.perfetto.dev or chrome://tracing");
  run.add_flag("--no-report", arguments.no_report,
               "write no log, no films, no report and no picture of the bench");
  run.add_option(
         "--pictures", arguments.pictures,
         "the camera's first and last pictures: always; failed: only if the run does not reach its goal")
      ->check(CLI::IsMember({"always", "failed"}))
      ->capture_default_str();
  run.add_option("--renderers", arguments.renderers,
                 "pictures that are drawn at the same time; they do not depend on it")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  run.add_flag("--json", arguments.json, "print summary.json instead of the table");
  run.add_flag(
      "--live", arguments.live,
      "show the run in a browser, where the target, gains and faults can be changed; it then lasts until "
      "Ctrl-C or the page ends it");
  arguments.of_live = {
      run.add_option("--port", arguments.page.port, "with --live: port of the page; 0: any free one")
          ->check(CLI::Range(0, 65535))
          ->capture_default_str(),
      run.add_option(
             "--address", arguments.page.address,
             "with --live: address to listen at; every computer that reaches it and knows the printed "
             "token has control")
          ->capture_default_str(),
      run.add_option("--live-origin", arguments.page.origins,
                     "with --live: origin of a web page that may connect too, e.g. https://app.foxglove.dev")
          ->expected(1)
          ->allow_extra_args(false),
      run.add_flag("--open", arguments.page.open, "with --live: open the page in the browser")};
}

int RunCommand(const RunArguments& arguments, RendererPool* pool) {
  std::signal(SIGPIPE, SIG_IGN);  // nobody reads the progress any more: the run goes on
  linux_rt::Interrupt interrupt;  // from here on, Ctrl-C ends the run early and writes all files
  std::vector<std::string> assignments = arguments.assignments;
  if (arguments.seed >= 0) {
    assignments.push_back(fmt::format("run.seed={}", arguments.seed));
  }
  const Scenario scenario = LoadScenario(arguments.scenario, assignments);
  RunOptions options;
  options.pace = arguments.pace == "real" ? Pace::kReal : Pace::kLockstep;
  if (arguments.servo == "mcu") {
    if (options.pace == Pace::kReal) {
      throw config::InputError("--servo mcu requires --pace lockstep");
    }
    options.servo_image = arguments.servo_image.empty() ? config::ShareFolder() / "fovea-mcu.elf"
                                                        : std::filesystem::path(arguments.servo_image);
  }
  options.board = MakeBoard(arguments, scenario);
  options.out = arguments.out.empty() ? "out/" + scenario.name : arguments.out;
  options.report = !arguments.no_report;
  options.pictures_if_failed = arguments.pictures == "failed";
  options.renderers = arguments.renderers;
  options.pool = pool;
  options.trace = arguments.trace;
  options.command = arguments.command;
  options.interrupt = &interrupt;
  if (arguments.live) {
    return RunLive(scenario, options, arguments);
  }
  RefuseGiven(arguments.of_live, "--live");
  const Summary summary = RunScenario(scenario, options);
  PrintResult(summary, options, arguments.json);
  return ReachedItsGoal(summary) ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea::sim
