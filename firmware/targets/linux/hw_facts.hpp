// SPDX-License-Identifier: Apache-2.0
// The facts of a run on hardware, for its files.
#pragma once

#include <string>

#include "firmware/host/beliefs/learner.hpp"
#include "firmware/host/beliefs/run_watch.hpp"
#include "firmware/host/robots/robot.hpp"
#include "firmware/host/run/run_folder.hpp"
#include "firmware/targets/linux/hw_config.hpp"

namespace fovea::hw {

// The configuration of the folder `out`; empty: no files. The run never waits for a disk. `duration_s`: 0 if
// unknown. `command`: the command line, for the log. `tap`: gets each message of the log; may be empty.
run::RunFolderConfig FolderOf(const HwConfig& config, const robots::Robot& robot,
                              const config::ServoConfig& servo, const std::string& out, double duration_s,
                              const std::string& command, const log::LogTap& tap = {});

// What the configuration says of the values that a run may find wrong.
beliefs::Configured ConfiguredBeliefs(const HwConfig& config);
// What it wants the servo to learn.
beliefs::Learns LearnsOf(const HwConfig& config);

}  // namespace fovea::hw
