// SPDX-License-Identifier: Apache-2.0
// A run that exists only as messages, for tests with foreign clients: prints the server's address, then runs
// until its standard input ends.
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iostream>

#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "tests/support/temp_folder.hpp"

namespace fovea::live {
namespace {

Catalogue ExampleCatalogue() {
  Catalogue catalogue;
  catalogue.name = "example";
  catalogue.channels = LogChannels({.truth = true});
  catalogue.parameters = {
      {"servo.lambda", "1/s", "the error decays like exp(-lambda t)", 0.1, 10.0, 2.0, 2.0}};
  catalogue.tune = true;
  catalogue.faults = {{"load", "a heavier load", {{"load_mass", "its mass", "kg", 0.0, 3.0, 1.0}}}};
  catalogue.services = {Service::kHold, Service::kTrack, Service::kSave, Service::kStartFault};
  catalogue.target = true;
  return catalogue;
}

struct Run {
  State state;

  Answer operator()(const Call& call) {
    if (std::holds_alternative<Hold>(call.request)) {
      state.mode = "hold";
    } else if (std::holds_alternative<Track>(call.request)) {
      return {"the target was not seen yet", ""};
    } else if (std::holds_alternative<Save>(call.request)) {
      return {"", R"({"name":"example-at-1.000s.toml","toml":"[run]"})"};
    } else if (const auto* start = std::get_if<StartFault>(&call.request)) {
      state.faults[start->fault] = {true, {start->sizes.at("load_mass")}};
    } else if (const auto* hold = std::get_if<HoldTarget>(&call.request)) {
      state.target = TargetState{hold->p_BO, hold->q_BO, true};
    } else if (std::holds_alternative<ReleaseTarget>(call.request) ||
               std::holds_alternative<ControlEnded>(call.request)) {
      state.target.reset();
    }
    return {};
  }
};

bool InputEnds() {
  pollfd waits{STDIN_FILENO, POLLIN, 0};
  char byte = 0;
  return poll(&waits, 1, 0) > 0 && read(STDIN_FILENO, &byte, 1) <= 0;
}

void Serve() {
  const test::TempFolder folder;
  std::ofstream(folder.path() / "index.html") << "<title>example</title>";
  ServerConfig config;
  config.page = folder.path();
  config.port = 0;
  const Catalogue catalogue = ExampleCatalogue();
  Server server(config, catalogue);
  LiveFeed feed(server, catalogue.channels);
  Run run;
  run.state.mode = "track";
  run.state.faults.resize(1);
  log::Setup setup;
  setup.set_name("example");
  setup.set_lambda(2.0);
  feed.Take(log::kSetupTopic, *log::Setup::descriptor(), 0, setup.SerializeAsString());
  std::cout << server.url() << std::endl;
  for (std::uint64_t tick = 0; !InputEnds(); ++tick) {
    log::Tick message;
    message.set_tick(tick);
    message.set_stamp_ns(static_cast<std::int64_t>(tick) * 1'000'000);
    message.add_e(0.5);
    feed.Take(log::kTickTopic, *log::Tick::descriptor(), message.stamp_ns(), message.SerializeAsString());
    run.state.stamp_s = 1e-3 * static_cast<double>(tick);
    server.TakeCalls([&run](const Call& call) { return run(call); });
    server.SetState(run.state);
    static_cast<void>(server.WaitForCalls(std::chrono::milliseconds(1)));
  }
}

}  // namespace
}  // namespace fovea::live

int main() {
  try {
    fovea::live::Serve();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
