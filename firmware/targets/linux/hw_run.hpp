// SPDX-License-Identifier: Apache-2.0
// Runs the servo on the robot until somebody ends it.
#pragma once

#include <optional>
#include <string>

#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/hw_live.hpp"
#include "firmware/targets/linux/hw_summary.hpp"
#include "fovea/linux_rt/speaker.hpp"

namespace fovea::hw {

struct HwRunOptions {
  bool allow_motion = true;
  bool enable = false;                // the arm may move from the start; false: after the operator's "enable"
  bool track = false;                 // track the target from the start; needs a camera
  double duration_s = 0.0;            // of the servo, by the loop's clock; 0: until somebody ends it
  std::string out;                    // the folder for log, report and summary; empty: none
  std::string command;                // the command line, for the log; "" if there is none
  std::optional<HwLiveOptions> live;  // show the run on a page; needs `out`
};

// Connects, waits for the operator's permission (see operator_input.hpp) while the robot holds by itself,
// compares gravity with the measured joint torques, runs the servo on a real-time thread, and ends in order.
// At "end", SIGINT, SIGTERM, SIGHUP or after the duration, the arm is brought to rest and the motion is
// finished in the robot's own way before the connection is closed; a second request ends at once. "recover"
// or SIGUSR1 makes a stopped robot recover and the servo start again. If the operator is silent for longer
// than input.dead_man_s, the arm is held. Without a camera the arm is held where it stands. Neither `speaker`
// nor a file delays any of this. InputError (also for a folder that cannot be written to), NetworkError,
// CameraError.
HwSummary Run(const HwConfig& config, const HwRunOptions& options, linux_rt::Speaker& speaker);

}  // namespace fovea::hw
