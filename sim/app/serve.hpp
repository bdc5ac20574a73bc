// The simulated robot on the network: `fovea-sim serve`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/panda/server.hpp"
#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

struct ServeOptions {
  std::string address = "127.0.0.1";    // where to listen; loopback unless told otherwise
  std::string camera_serial = "fovea";  // of the GigE Vision camera; empty: there is none
  std::vector<CartesianWall> walls;     // which the end effector may not enter
  FciServerConfig server;               // all but its address, of which the port counts
};

// What was served, and how the bench stood in the end.
struct ServeSummary {
  FciServerCounters robot;
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_dropped = 0;  // never drawn: what draws and sends was half a second behind the robot
  // Against the simulator's truth; none without a camera.
  std::optional<double> error_px;
  std::optional<double> error_mm;
};

// Serves the scenario's arm as a Panda, and its camera, until SIGINT or SIGTERM; SIGUSR1 presses the
// stop button, and again releases it; so does a line on standard input, which does more (serve_keys.hpp).
// `say` gets a line for each thing that a
// person may want to know. InputError: a scenario that cannot be served. std::runtime_error: a port is taken,
// no picture can be drawn.
ServeSummary Serve(const Scenario& scenario, const ServeOptions& options,
                   const std::function<void(const std::string&)>& say);

// As a JSON object.
std::string ToJson(const ServeSummary& summary);

}  // namespace fovea::sim
