// The simulated robot on the network: `fovea-sim serve`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/panda/server.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

struct ServeOptions {
  std::string address = "127.0.0.1";    // where to listen; loopback unless told otherwise
  std::string camera_serial = "fovea";  // of the GigE Vision camera; empty: there is none
  std::vector<CartesianWall> walls;     // which the end effector may not enter
  FciServerConfig server;               // all but its address, of which the port counts
  std::filesystem::path out;            // for summary.json; empty: no files
};

// What was served, and how the bench stood in the end. The servo is the client's, and so are its ticks, their
// log and their report; the truth is known here alone, and the client's summary has null for it.
struct ServeSummary {
  std::string scenario;
  int seed = 0;
  std::string pace;
  double sim_time_s = 0.0;  // of the robot
  FciServerCounters robot;
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_dropped = 0;  // never drawn: what draws and sends was half a second behind the robot
  // At the end, against the simulator's truth; none without a camera.
  std::optional<double> error_px;  // infinite when the target is behind it
  std::optional<double> error_mm;
  std::optional<double> error_lateral_mm;
  std::optional<double> error_depth_mm;
  std::optional<double> error_deg;  // none for a sphere, which has no orientation
  std::uint64_t contact_ticks = 0;  // in which the arm touched bench, target or itself
  ContactTicks contacts;
  std::vector<std::string> realtime_missing;  // what the machine did not grant at real pace
};

// Serves the scenario's arm as a Panda, and its camera, until SIGINT, SIGTERM or SIGHUP; SIGUSR1 presses the
// stop button, and again releases it; so does a line on standard input, which does more (serve_keys.hpp).
// `say` gets a line for each thing that a
// person may want to know. Leaves summary.json in `options.out`, by the code that any run leaves its own
// with. InputError: a scenario that cannot be served, a folder that cannot be written to. std::runtime_error:
// a port is taken, no picture can be drawn.
ServeSummary Serve(const Scenario& scenario, const ServeOptions& options,
                   const std::function<void(const std::string&)>& say);

// As a JSON object: summary.json.
std::string ToJson(const ServeSummary& summary);

}  // namespace fovea::sim
