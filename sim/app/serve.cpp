// SPDX-License-Identifier: Apache-2.0
#include "sim/app/serve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <sstream>
#include <thread>
#include <utility>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "firmware/host/run/run_folder.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/signal_queue.hpp"
#include "sim/operator/served_page.hpp"
#include "sim/run/network_eye.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/fault_settings.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/serve_keys.hpp"
#include "sim/scenario/world_config.hpp"
#include "sim/truth/truth_text.hpp"
#include "sim/verdict/contact_count.hpp"
#include "sim/verdict/target_error.hpp"

namespace fovea::sim {
namespace {

constexpr int kLookMs = 50;

using Say = std::function<void(const std::string&)>;

// A person at the bench: presses the buttons, pulls the hand, makes the robot hang.
class Person {
 public:
  Person(FciServer& server, const Say& say) : server_(server), say_(say) {}

  void PressStop() { server_.PressStop(stops_ = !stops_); }
  void Do(const ServeKey& key) {
    switch (key.kind) {
      case ServeKey::Kind::kStop: PressStop(); break;
      case ServeKey::Kind::kGuide: server_.PressGuiding(guides_ = !guides_); break;
      case ServeKey::Kind::kPull: server_.PullHand(key.force_B); break;
      case ServeKey::Kind::kHang:
        server_.Hang(hangs_ = !hangs_);
        say_(hangs_ ? "the robot hangs" : "the robot continues");
        break;
      case ServeKey::Kind::kUnknown:
        say_("unknown command; use s (stop), g (guide), f X Y Z (pull the hand [N]), h (hang)");
        break;
    }
  }

 private:
  FciServer& server_;
  const Say& say_;
  bool stops_ = false;
  bool guides_ = false;
  bool hangs_ = false;
};

// Empty if the file is missing.
std::vector<std::byte> ReadModelLibrary() {
  std::ifstream file(config::ShareFolder() / "model_library" / "panda.so", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void CheckIsPanda(const RunDescription& about) {
  if (about.robot.name != "panda" || about.servo.arm.num_joints != franka::kJoints) {
    throw config::InputError(fmt::format(
        "arm.model = \"{}\" is not allowed: `serve` speaks the Franka Control Interface and needs \"panda\"",
        about.scenario.arm.model));
  }
}

void FillError(const TargetError& error, ServeSummary& summary) {
  constexpr double kMmPerM = 1e3;
  summary.error_px = error.error_px;
  summary.error_mm = kMmPerM * error.error_C.norm();
  summary.error_lateral_mm = kMmPerM * error.error_C.head<2>().norm();
  summary.error_depth_mm = kMmPerM * std::fabs(error.error_C.z());
  if (error.error_rad) {
    summary.error_deg = *error.error_rad * 180.0 / std::numbers::pi;
  }
}

}  // namespace

CartesianWall ParseWall(const std::string& text) {
  std::istringstream words(text);
  std::array<double, 6> v{};
  bool commas = true;
  for (std::size_t i = 0; i < v.size(); ++i) {
    words >> v[i];
    if (i + 1 < v.size()) {
      char comma = 0;
      words >> comma;
      commas = commas && comma == ',';
    }
  }
  if (words.fail() || !commas || words.peek() != std::istringstream::traits_type::eof() ||
      std::any_of(v.begin() + 3, v.end(), [](double edge) { return !(edge > 0.0); })) {
    throw config::InputError(fmt::format(
        "--wall {} is not allowed: expected X,Y,Z,DX,DY,DZ, a corner and three edges above 0 [m]", text));
  }
  CartesianWall wall;
  wall.X_BW.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  wall.size = {v[3], v[4], v[5]};
  return wall;
}

ServeSummary Serve(const Scenario& scenario, const ServeOptions& options, const Say& say) {
  const RunDescription about = DescribeRun(scenario);
  CheckIsPanda(about);
  CheckServedFaults(scenario.faults);
  const linux_rt::SignalQueue signals({SIGINT, SIGTERM, SIGHUP, SIGUSR1});
  WorldConfig bench = MakeWorldConfig(about);
  bench.physics.may_be_loaded = options.live.has_value();  // a viewer may hang a load at the hand
  World world(bench);
  FciRobot robot(world, about.robot_truth.believed.value_or(about.scene.robot), options.walls);
  FciServerConfig config = options.server;
  config.at.ip = franka::Resolve(options.address, 0).ip;
  config.seed = static_cast<std::uint64_t>(scenario.run.seed);
  config.model_library = ReadModelLibrary();
  if (config.model_library.empty()) {
    say("model library not found: LoadModelLibrary returns an error");
  }
  std::optional<ServedPage> page;  // outlives the eye, which gives it pictures
  std::optional<NetworkEye> eye;
  if (options.live) {
    page.emplace(*options.live, about, world, [&eye](const FaultSettings& faults) {
      if (eye) {
        eye->SetFaults(faults);
      }
    });
  }
  if (scenario.camera.enabled && !options.camera_serial.empty()) {
    WatchedCamera::Watcher watcher;
    if (page) {
      watcher = [&page](const hal::Frame& frame) { page->AddPicture(frame); };
    }
    eye.emplace(about, world, options.address, options.camera_serial, config.lockstep, std::move(watcher));
  }
  config.after_step = [&eye, &page] {
    if (eye) {
      eye->Advance();
    }
    if (page) {
      page->AfterStep();
    }
  };
  ContactCount contacts;
  world.OnStep([&contacts](const Truth& truth) { contacts.Add(truth.contacts); });
  FciServer server(robot, config);
  run::RunFolder folder({options.out, std::nullopt, {}});  // last: a refused scenario leaves no folder
  say(fmt::format("serving scenario {} at {}:{}, {} pace", scenario.name, options.address, server.port(),
                  config.lockstep ? "lockstep" : "real"));
  if (eye) {
    say(fmt::format("camera \"{}\" at {}: GigE Vision, {} x {} px", options.camera_serial, options.address,
                    about.pinhole.width_px, about.pinhole.height_px));
  }
  if (page) {
    say("live at " + page->url());
  }

  ServeSummary summary;
  std::atomic<bool> stop{false};
  std::exception_ptr failure;
  std::mutex saying;
  const Say say_from_any = [&](const std::string& line) {
    const std::lock_guard lock(saying);
    say(line);
  };
  std::jthread thread([&] {
    try {
      if (!config.lockstep) {
        summary.realtime_missing = linux_rt::MakeThreadRealtime({});
        for (const std::string& line : summary.realtime_missing) {
          say_from_any("real time: " + line);
        }
      }
      server.Run(stop, say_from_any);
    } catch (...) {
      failure = std::current_exception();
      stop = true;
    }
  });
  ServeKeys keys;
  Person person(server, say_from_any);
  while (!stop) {
    const int signal = signals.Next(kLookMs);
    if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP || (page && page->ended())) {
      stop = true;  // never false again: the robot's thread sets it, too
    }
    if (signal == SIGUSR1) {
      person.PressStop();
    }
    while (const std::optional<ServeKey> key = keys.Next()) {
      person.Do(*key);
    }
  }
  thread.join();
  if (failure) {
    std::rethrow_exception(failure);
  }
  summary.scenario = scenario.name;
  summary.seed = scenario.run.seed;
  summary.truth = about.truth;
  summary.pace = config.lockstep ? "lockstep" : "real";
  summary.sim_time_s = static_cast<double>(world.now_ns()) * 1e-9;
  summary.robot = server.counters();
  summary.contact_ticks = contacts.any();
  summary.contacts = contacts.by_what();
  if (eye) {
    summary.error = eye->fault().empty() ? "" : "the camera failed: " + eye->fault();
    summary.frames_sent = eye->sent();
    summary.frames_dropped = eye->dropped();
    FillError(ErrorOf(world.truth(), JudgedEyeOf(about), GoalOf(about.servo.feature)), summary);
  }
  try {
    folder.Write(ToJson(summary));
  } catch (const std::exception& error) {
    summary.error += (summary.error.empty() ? "" : "; ") + std::string(error.what());
  }
  return summary;
}

std::string ToJson(const ServeSummary& s) {
  using Json = nlohmann::ordered_json;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  const FciServerCounters& c = s.robot;
  Json json;
  run::BeginSummary(json);
  json.update(Json{
      {"scenario", s.scenario},
      {"seed", s.seed},
      {"pace", s.pace},
      {"sim_time_s", s.sim_time_s},
      {"clients", c.clients},
      {"refused_clients", c.refused_clients},
      {"states", c.states},
      {"commands", c.commands},
      {"missing", c.missing},
      {"unused", c.unused},
      {"malformed", c.malformed},
      {"overruns", c.overruns},
      {"given_up_ms", static_cast<double>(c.given_up_ns) / hal::kNsPerMs},
      {"frames_sent", s.frames_sent},
      {"frames_dropped", s.frames_dropped},
      {"error_px", or_null(s.error_px)},
      {"error_mm", or_null(s.error_mm)},
      {"error_lateral_mm", or_null(s.error_lateral_mm)},
      {"error_depth_mm", or_null(s.error_depth_mm)},
      {"error_deg", or_null(s.error_deg)},
      {"contact_ticks", s.contact_ticks},
      {"contacts", {{"bench", s.contacts.bench}, {"target", s.contacts.target}, {"self", s.contacts.self}}},
      {"realtime_missing", s.realtime_missing},
      {"truth", TruthAsJson(s.truth)}});
  run::AddBuild(json);
  // Replaces invalid UTF-8: a scenario's file name may hold any bytes.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace fovea::sim
