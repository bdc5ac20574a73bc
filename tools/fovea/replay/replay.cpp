// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/replay/replay.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/renew.hpp"
#include "firmware/host/recording/flight/replay.hpp"
#include "tools/fovea/replay/page.hpp"
#include "tools/fovea/replay/settings.hpp"
#include "tools/fovea/replay/text.hpp"

namespace fovea {
namespace {

void WritePage(const std::filesystem::path& out, const std::string& page) {
  std::ofstream stream(out, std::ios::binary | std::ios::trunc);
  stream << page;
  stream.close();
  if (!stream) {
    throw std::runtime_error(out.string() + ": cannot be written");
  }
}

}  // namespace

const CLI::App* AddReplay(CLI::App& app, ReplayArguments& arguments) {
  CLI::App* replay = app.add_subcommand(
      "replay", "verify bit-exact replay: run the servo on a log's recorded inputs and compare");
  replay->add_option("log", arguments.log, "a log.mcap, or the folder of a run")->required();
  replay->add_option("--from", arguments.from_s, "begin at the first keyframe at or after this time [s]")
      ->check(CLI::NonNegativeNumber);
  replay
      ->add_option("--set", arguments.settings,
                   "key=value of [servo] or [safety]: replay open loop with another value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  replay->add_option("--out", arguments.out,
                     "with --set: the page to write; default: replay.html beside the log");
  replay->add_flag("--renew", arguments.renew,
                   "rewrite the log with the outputs of this servo (for golden logs)");
  replay->add_flag("--json", arguments.json, "print JSON");
  replay->footer(
      "Examples:\n"
      "  fovea replay out/ball\n"
      "  fovea replay out/ball --from 4 --json\n"
      "  fovea replay out/ball --set servo.lambda=3 --set servo.omega_n=30 --out gain.html\n"
      "  fovea replay tests/host/recording/flight/golden/tour.mcap --renew\n"
      "Exit: 0 all that can be replayed is bit-identical, or --set was given; 1 something differs; 2 wrong "
      "usage or input.");
  return replay;
}

int Replay(const ReplayArguments& arguments) {
  if (arguments.renew && (!arguments.settings.empty() || arguments.from_s > 0.0)) {
    throw config::InputError("--renew excludes --set and --from: it rewrites the whole log");
  }
  if (!arguments.out.empty() && arguments.settings.empty()) {
    throw config::InputError("--out needs --set: only a replay with changes has a page");
  }
  const std::filesystem::path log = flight::LogIn(arguments.log);
  flight::ReplayOptions options;
  options.build = BuildEntries();
  options.from_s = arguments.from_s;
  ReplayPage page;
  if (!arguments.settings.empty()) {
    options.change = ChangeOf(log, arguments.settings);
    options.on_tick = [&page](const log::Tick& recorded, const log::Tick& replayed, const hal::TickRecord&) {
      page.Add(recorded, replayed);
    };
  }
  const flight::ReplayResult result = flight::Replay(log, options);
  if (arguments.json) {
    fmt::print("{}", ReplayJson(log.string(), result));
  } else if (arguments.settings.empty()) {
    config::PrintFitted(ReplayText(log.string(), result), 4);
    fmt::print("{}", ChangeTable(result));
  } else {
    fmt::print("{}: {} ticks with {}, compared with the recording\n{}", log.string(), result.ticks(),
               fmt::join(arguments.settings, ", "), ChangeTable(result));
  }
  if (arguments.renew && !result.Identical()) {
    flight::Renew(log, BuildEntries());
    fmt::print("{}: renewed\n", log.string());
    return config::kDone;
  }
  if (!arguments.settings.empty()) {
    if (result.ticks() == 0) {
      throw std::runtime_error(log.string() + ": no part of it can be replayed");
    }
    const std::filesystem::path out =
        arguments.out.empty() ? log.parent_path() / "replay.html" : std::filesystem::path(arguments.out);
    WritePage(out, page.Make(log.string(), arguments.settings, result));
    if (!arguments.json) {
      fmt::print("{}\n", out.string());
    }
    return config::kDone;
  }
  return result.Identical() ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
