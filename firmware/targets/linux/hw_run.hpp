// The servo on the robot, until somebody ends it.
#pragma once

#include <string>

#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/hw_summary.hpp"
#include "firmware/targets/linux/speaker.hpp"

namespace fovea::hw {

struct HwRunOptions {
  bool allow_motion = true;
  bool enable = false;      // the arm may move from the start; else when the operator says so
  bool track = false;       // and steers by the target; needs a camera
  double duration_s = 0.0;  // of the servo, by the loop's clock; 0: until it is told to end
  std::string out;          // the folder for log, report and summary; empty: none
  std::string command;      // the command line, for the log; "" when there was none
};

// Connects, waits for the operator's leave (see operator_input.hpp) while the robot holds by itself, compares
// gravity with what the joints feel, runs the servo on a real-time thread, and ends in order: at "end",
// SIGINT, SIGTERM, SIGHUP or after the duration the arm is brought to rest, and the motion is finished by the
// robot's own way before the connection is closed; told a second time, at once. "recover" or SIGUSR1 asks a
// robot that stopped to recover, and the servo to start anew. An operator who is silent for longer than
// input.dead_man_s has the arm held. Without a camera it is held where it stands. Neither what `speaker` says
// nor what is written delays any of this. InputError (also of a folder that cannot be written to),
// NetworkError, CameraError.
HwSummary Run(const HwConfig& config, const HwRunOptions& options, Speaker& speaker);

}  // namespace fovea::hw
