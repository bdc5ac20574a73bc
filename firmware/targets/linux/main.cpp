// SPDX-License-Identifier: Apache-2.0
// fovea-hw: the servo on the robot.
#include <fmt/format.h>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/command_line.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/key_text.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/targets/linux/check.hpp"
#include "firmware/targets/linux/hw_run.hpp"
#include "fovea/linux_rt/speaker.hpp"

namespace {

using namespace fovea;

struct Arguments {
  std::string config;
  std::vector<std::string> assignments;
  bool check = false;
  bool keys = false;
  bool no_motion = false;
  bool enable = false;
  bool track = false;
  bool json = false;
  double seconds = 0.0;
  std::string out;
  bool live = false;
  bool live_control = false;
  std::string address = "127.0.0.1";
  int port = 8765;
  std::vector<std::string> origins;
  std::vector<const CLI::Option*> of_live;  // require --live
  std::string command;                      // the whole command line
};

// None without --live.
std::optional<hw::HwLiveOptions> LiveOf(const Arguments& arguments) {
  if (!arguments.live) {
    for (const CLI::Option* option : arguments.of_live) {
      if (option->count() > 0) {
        throw config::InputError(option->get_name() + " requires --live");
      }
    }
    return std::nullopt;
  }
  if (arguments.out.empty()) {
    throw config::InputError("--live requires --out: the page shows what is logged");
  }
  hw::HwLiveOptions live;
  live.control = arguments.live_control;
  live.server.address = arguments.address;
  live.server.port = static_cast<std::uint16_t>(arguments.port);
  live.server.allowed_origins = arguments.origins;
  return live;
}

int Check(const hw::HwConfig& config, bool json) {
  const std::vector<hw::CheckRow> rows = hw::Check(config);
  fmt::print("{}", json ? hw::ToJson(rows) : hw::ToTable(rows, config::StyleOf(STDOUT_FILENO)));
  return hw::AnyFails(rows) ? config::kGoalMissed : config::kDone;
}

// None after an error, which it prints.
std::optional<hw::HwSummary> Serve(const hw::HwConfig& config, const Arguments& arguments) {
  linux_rt::Speaker speaker(STDERR_FILENO);
  try {
    return hw::Run(config,
                   {!arguments.no_motion, arguments.enable || arguments.track, arguments.track,
                    arguments.seconds, arguments.out, arguments.command, LiveOf(arguments)},
                   speaker);
  } catch (const std::exception& error) {
    speaker.Say(fmt::format("fovea-hw: {}", error.what()));
    return std::nullopt;
  }
}

void PrintVerdict(const hw::HwSummary& summary) {
  const config::TextStyle style = config::StyleOf(STDOUT_FILENO);
  std::string lines = config::Fitted(summary.verdict, config::kContinued, style.width);
  lines.pop_back();  // its line end
  const config::Paint paint = !summary.converged   ? config::Paint::kPlain
                              : *summary.converged ? config::Paint::kGood
                                                   : config::Paint::kBad;
  fmt::print("{}\n", config::Painted(lines, paint, style));
}

int Run(const Arguments& arguments) {
  hw::HwConfig config = hw::LoadHwConfig(arguments.config, arguments.assignments);
  if (arguments.keys) {
    fmt::print("{}", config::KeysAsText(hw::HwKeys(config), config::TerminalWidth(STDOUT_FILENO)));
    return config::kDone;
  }
  if (arguments.check) {
    return Check(config, arguments.json);
  }
  if (arguments.track && !config.HasCamera()) {
    throw config::InputError("--track is not allowed: camera.driver = \"none\"");
  }
  const std::optional<hw::HwSummary> ended = Serve(config, arguments);
  if (!ended) {
    return config::kBadInput;
  }
  const hw::HwSummary& summary = *ended;
  if (arguments.json) {
    fmt::print("{}", hw::ToJson(summary));
  } else {
    if (summary.seen && summary.seen->last_px) {
      config::PrintFitted(fmt::format("{} frames, the target in {}; at the end {:.2f} px off its goal",
                                      summary.seen->frames, summary.seen->frames_detected,
                                      *summary.seen->last_px));
    }
    config::PrintFitted(fmt::format(
        "{} ticks, {} overruns; {} states, {} lost; {} commands, {:.0f} % of the last 100 arrived; "
        "ended in {}",
        summary.ticks, summary.overruns, summary.robot.states, summary.robot.lost_states,
        summary.robot.commands, 100.0 * summary.robot.command_success_rate, hal::Name(summary.mode)));
    PrintVerdict(summary);
  }
  if (!summary.files_error.empty()) {
    throw config::InputError(summary.files_error);
  }
  return summary.converged.value_or(true) ? config::kDone : config::kGoalMissed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Fovea on hardware: servo a Franka Emika Panda with a camera on its hand."};
  app.set_version_flag("--version", fmt::format("fovea-hw {} {}", kVersion, kGitRevision));
  app.footer(
      "Examples:\n"
      "  fovea-hw panda --check\n"
      "  fovea-hw panda --keys\n"
      "  fovea-hw panda --no-motion --seconds 10\n"
      "  fovea-sim serve ball --pace lockstep & fovea-hw loopback --track --seconds 8 --out out/hw\n"
      "Words on standard input, one per line: enable, track, hold, recover, end. SIGUSR1 recovers; SIGINT, "
      "SIGTERM and SIGHUP end the run, a second one at once.\n"
      "Dead man's switch: after input.dead_man_s (5 s; 0 in loopback: never) without a line the arm is held, "
      "also with --enable and --track. For a run without an operator: --set input.dead_man_s=0\n"
      "Before the arm moves, gravity is compared with the measured joint torques (check.gravity_torque).\n"
      "Exit: 0 done; 1 the run ended in a fault, motion was refused, the target was never seen or not "
      "brought to its goal, the servo never began, or a check failed; 2 wrong usage or input.");
  Arguments arguments;
  arguments.command = config::CommandLine(argc, argv);
  app.add_option("config", arguments.config, "a shipped configuration by name, or the path of a .toml")
      ->required();
  app.add_option("--set", arguments.assignments, "key=value, overrides the configuration; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_flag("--check", arguments.check,
               "check computer, robot and camera without motion, and print what to fix");
  app.add_flag("--keys", arguments.keys, "print every key of the configuration: value, meaning, range, unit");
  app.add_flag("--no-motion", arguments.no_motion, "read states, command nothing");
  app.add_flag("--enable", arguments.enable, "enable motion from the start; without it, type \"enable\"");
  app.add_flag("--track", arguments.track,
               "enable motion and track the target from the start; without it, type \"track\"");
  app.add_option("--seconds", arguments.seconds, "end after this time; without it, run until a signal")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--out", arguments.out,
                 "folder for log.mcap, report.html and summary.json; without it, write no files");
  app.add_flag("--json", arguments.json, "print the summary as JSON");
  app.add_flag("--live", arguments.live,
               "show the run in a browser, where a viewer may hold the arm and end the run; needs --out");
  arguments.of_live = {
      app.add_flag("--live-control", arguments.live_control,
                   "with --live: a viewer may also track, recover and change gains, but never enable motion"),
      app.add_option("--port", arguments.port, "with --live: port of the page; 0: any free one")
          ->check(CLI::Range(0, 65535))
          ->capture_default_str(),
      app.add_option(
             "--address", arguments.address,
             "with --live: address to listen at; every computer that reaches it and knows the printed "
             "token may use the page")
          ->capture_default_str(),
      app.add_option("--live-origin", arguments.origins,
                     "with --live: origin of a web page that may connect too, e.g. https://app.foxglove.dev")
          ->expected(1)
          ->allow_extra_args(false)};
  return config::RunProgram("fovea-hw", app, argc, argv, [&] { return Run(arguments); });
}
