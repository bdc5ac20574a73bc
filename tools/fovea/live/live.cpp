// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/live/live.hpp"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <utility>

#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/report/report.hpp"
#include "fovea/linux_rt/interrupt.hpp"
#include "tools/fovea/live/player.hpp"

namespace fovea {
namespace {

// The channels of the log's run: those of a camera, and of a simulator, only if it has them.
std::vector<live::Channel> ChannelsIn(const std::filesystem::path& log) {
  std::set<std::string, std::less<>> topics;
  log::McapVisitor visitor;
  visitor.on_message = [&](const log::McapMessage& message) { topics.emplace(message.topic); };
  static_cast<void>(log::ReadMcap(log, visitor));
  const auto has = [&](const char* topic) { return topics.contains(std::string_view(topic)); };
  return live::LogChannels({.camera = has(log::kCalibrationTopic),
                            .truth = has(log::kTruthTopic),
                            .theory = has(log::kTheoryTopic),
                            .configuration = has(log::kConfigurationTopic)});
}

}  // namespace

const CLI::App* AddLive(CLI::App& app, LiveArguments& arguments) {
  CLI::App* live = app.add_subcommand("live", "play a log on the live page, as if it came now");
  live->add_option("log", arguments.log, "a log.mcap, or the folder of a run")->required();
  live->add_option("--speed", arguments.speed, "time of the log per time of the clock; 0: as fast as it goes")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  live->add_option("--port", arguments.port, "port of the page; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  live->add_option(
          "--address", arguments.address,
          "address to listen at; every computer that reaches it and knows the printed token can watch")
      ->capture_default_str();
  live->add_option("--live-origin", arguments.origins,
                   "origin of a web page that may connect too, e.g. https://app.foxglove.dev")
      ->expected(1)
      ->allow_extra_args(false);
  live->footer(
      "Examples:\n"
      "  fovea live out/ball\n"
      "  fovea live out/ball --speed 0.2 --port 9000\n"
      "The page may pause, step, change the speed, begin again and end. Foxglove and Lichtblick can connect, "
      "too.");
  return live;
}

int Live(const LiveArguments& arguments) {
  const std::filesystem::path log = flight::LogIn(arguments.log);
  live::Catalogue catalogue;
  catalogue.name = log.string();
  catalogue.channels = ChannelsIn(log);
  catalogue.services = {live::Service::kPause, live::Service::kStep, live::Service::kSpeed,
                        live::Service::kReset, live::Service::kEnd};
  live::ServerConfig config;
  config.address = arguments.address;
  config.port = static_cast<std::uint16_t>(arguments.port);
  config.allowed_origins = arguments.origins;
  config.report = [&log] {
    return report::ReportPage(config::ShareFolder() / "report").Make({report::ReadRun(log)});
  };
  linux_rt::Interrupt interrupt;
  live::Server server(std::move(config), catalogue);
  live::LiveFeed feed(server, catalogue.channels);
  fmt::print("live at {}\nCtrl-C ends it.\n", server.url());
  std::fflush(stdout);
  LogPlayer(server, feed, arguments.speed).Play(log, [&] { return interrupt.Came(); });
  return config::kDone;
}

}  // namespace fovea
