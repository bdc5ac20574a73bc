// SPDX-License-Identifier: Apache-2.0
// The simulated robot on the network: `fovea-sim serve`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/live/server.hpp"
#include "sim/panda/server.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

struct ServeOptions {
  std::string address = "127.0.0.1";       // address to listen on
  std::string camera_serial = "fovea";     // of the GigE Vision camera; empty: no camera
  std::vector<CartesianWall> walls;        // cuboids that the end effector may not enter
  FciServerConfig server;                  // `at.port` is used; `at.ip` comes from `address`
  std::filesystem::path out;               // for summary.json; empty: no files
  std::optional<live::ServerConfig> live;  // a page that shows the bench; none: no page
};

// What was served, and the true state of the bench at the end. The client runs the servo and writes the log
// and the report of its ticks. Only the server knows the truth; the client's summary has null for it.
struct ServeSummary {
  std::string scenario;
  int seed = 0;
  std::vector<TrueValue> truth;  // what is not as the client believes
  std::string pace;
  double sim_time_s = 0.0;  // of the robot
  FciServerCounters robot;
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_dropped = 0;  // never drawn: the drawing thread was half a second behind the robot
  // Final errors by the simulator's truth; none without a camera.
  std::optional<double> error_px;  // infinite if the target is behind the camera
  std::optional<double> error_mm;
  std::optional<double> error_lateral_mm;
  std::optional<double> error_depth_mm;
  std::optional<double> error_deg;  // none for a sphere, which has no orientation
  std::uint64_t contact_ticks = 0;  // ticks in which the arm touched bench, target or itself
  ContactTicks contacts;
  std::vector<std::string> realtime_missing;  // at real pace: missing real-time privileges
  std::string error;  // why the camera failed or the folder could not be written; not in summary.json
};

// Serves the scenario's arm as a Panda, and its camera, until SIGINT, SIGTERM, SIGHUP or the page ends it.
// SIGUSR1 presses and releases the stop button. Lines on standard input do this and more (serve_keys.hpp).
// Calls `say` with each message for the person. Writes summary.json to `options.out`. InputError: the
// scenario cannot be served, or the folder cannot be made, or the page's port is in use. std::runtime_error:
// a port is in use, or no picture can be drawn.
ServeSummary Serve(const Scenario& scenario, const ServeOptions& options,
                   const std::function<void(const std::string&)>& say);

// Parses "x,y,z,dx,dy,dz": a corner and the edge lengths from that corner [m]. InputError when it is not
// that.
CartesianWall ParseWall(const std::string& text);

// The JSON text of summary.json.
std::string ToJson(const ServeSummary& summary);

}  // namespace fovea::sim
