// SPDX-License-Identifier: Apache-2.0
// What viewers ask of a run. The server has checked each request: its numbers are finite and in the stated
// ranges, its quaternions have length 1, the names are those of the catalogue, and the client has control.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <variant>

namespace fovea::live {

inline constexpr double kMostMetres = 100.0;     // of a position, per axis
inline constexpr double kMostSpeed = 20.0;       // of a thrown target [m/s], per axis
inline constexpr double kMostTurnSpeed = 100.0;  // of a thrown target [rad/s], per axis
inline constexpr int kMostSteps = 1000;          // ticks
inline constexpr double kLeastFactor = 0.1;      // of slow motion

struct Hold {};
struct Track {};
struct Recover {};
struct Pause {
  bool paused = false;
};
// Runs this many ticks of a paused run.
struct Step {
  int ticks = 1;  // 1 to kMostSteps
};
struct Speed {
  double factor = 1.0;  // kLeastFactor to 1; 0: as fast as it goes
};
// Back to the start of the scenario.
struct Reset {};
// The answer's json is {"name": file name, "toml": its text}.
struct Save {};
struct End {};
// Begins the fault, or changes the sizes of an active one.
struct StartFault {
  std::size_t fault = 0;                // index in Catalogue::faults
  std::map<std::string, double> sizes;  // of the settings that were given, by name; each in its range
};
struct StopFault {
  std::size_t fault = 0;
};
// A spring from a point of the link to a point in B.
struct Pull {
  std::string link;                // a frame of /tf
  std::array<double, 3> p_link{};  // in the link's frame [m]
  std::array<double, 3> to_B{};    // [m]
};
struct Release {};
// Lets the target fly.
struct Throw {
  std::array<double, 3> v_BO{};     // [m/s]
  std::array<double, 3> omega_B{};  // [rad/s]
};
// Holds the target at a pose until ReleaseTarget or Throw.
struct HoldTarget {
  std::array<double, 3> p_BO{};                    // [m]
  std::array<double, 4> q_BO{1.0, 0.0, 0.0, 0.0};  // w, x, y, z
};
// The target stays where HoldTarget put it. No motion that it had before goes on.
struct ReleaseTarget {};
struct SetParameter {
  std::size_t parameter = 0;  // index in Catalogue::parameters
  double value = 0.0;         // in its range
};
// From the server itself: the controller left, gave up control or was silent for too long. The program ends
// what that client held: the target, and the pull on the arm.
struct ControlEnded {};

using Request =
    std::variant<Hold, Track, Recover, Pause, Step, Speed, Reset, Save, End, StartFault, StopFault, Pull,
                 Release, Throw, HoldTarget, ReleaseTarget, SetParameter, ControlEnded>;

struct Call {
  std::string client;  // name of the viewer, for touches in the log and for notices
  Request request;
};

// One line of `error` refuses the request; the viewer reads it. Without an error, `json` answers a service.
struct Answer {
  std::string error;
  std::string json = "{}";
};

}  // namespace fovea::live
