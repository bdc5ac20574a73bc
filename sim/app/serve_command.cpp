// SPDX-License-Identifier: Apache-2.0
#include "sim/app/serve_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <stdexcept>

#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/speaker.hpp"
#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

int ServeCommand(const ServeArguments& arguments) {
  std::vector<std::string> assignments = arguments.assignments;
  if (arguments.seed >= 0) {
    assignments.push_back(fmt::format("run.seed={}", arguments.seed));
  }
  ServeOptions options = arguments.options;
  options.server.lockstep = arguments.pace == "lockstep";
  for (const std::string& wall : arguments.walls) {
    options.walls.push_back(ParseWall(wall));
  }
  if (arguments.live) {
    options.live = arguments.page;
  }
  const Scenario scenario = LoadScenario(arguments.scenario, assignments);
  std::signal(SIGPIPE, SIG_IGN);
  linux_rt::Speaker speaker(STDERR_FILENO);
  const ServeSummary summary = Serve(scenario, options, [&](const std::string& line) { speaker.Say(line); });
  if (arguments.json) {
    fmt::print("{}", ToJson(summary));
  } else {
    const FciServerCounters& c = summary.robot;
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
  return config::kDone;
}

namespace {

void AddLive(CLI::App& serve, ServeArguments& arguments) {
  CLI::Option* const live = serve.add_flag(
      "--live", arguments.live,
      "show the bench in a browser, where the target, the arm and faults can be changed; the page may also "
      "end the serving");
  serve.add_option("--live-port", arguments.page.port, "with --live: port of the page; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str()
      ->needs(live);
  serve
      .add_option("--live-address", arguments.page.address,
                  "with --live: address to listen at; every computer that reaches it and knows the printed "
                  "token has control")
      ->capture_default_str()
      ->needs(live);
  serve
      .add_option("--live-origin", arguments.page.allowed_origins,
                  "with --live: origin of a web page that may connect too, e.g. https://app.foxglove.dev")
      ->expected(1)
      ->allow_extra_args(false)
      ->needs(live);
}

}  // namespace

void AddServe(CLI::App& serve, ServeArguments& arguments) {
  FciServerConfig& server = arguments.options.server;
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
  AddLive(serve, arguments);
  serve.add_option("--out", arguments.options.out, "folder for summary.json; without it, write no file");
  serve.add_flag("--json", arguments.json, "print summary.json at the end");
  serve.footer(
      "Type one command per line: s presses or releases the stop button; g presses or releases the enabling\n"
      "button for hand guiding; f X Y Z pulls the hand with this force [N]; h freezes the robot: it repeats\n"
      "one state.\n"
      "Examples:\n"
      "  fovea-sim serve ball --fci-port 1337\n"
      "  fovea-sim serve ball --pace lockstep --loss 0.05 --jitter-ms 2 --late-ms 3\n"
      "  fovea-sim serve ball --wall 0.1,0.2,0,0.6,0.5,0.8\n"
      "  fovea-sim serve ball --live");
}

}  // namespace fovea::sim
