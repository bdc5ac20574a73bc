// What a run on hardware is about, for what it leaves behind.
#pragma once

#include <string>

#include "firmware/host/robots/robot.hpp"
#include "firmware/host/run/run_folder.hpp"
#include "firmware/targets/linux/hw_config.hpp"

namespace fovea::hw {

// What it leaves in the folder `out`; empty: nothing. Nobody waits for a disk. `duration_s`: 0 when nobody
// knows. `command`: the command line, for the log.
run::RunFolderConfig FolderOf(const HwConfig& config, const robots::Robot& robot,
                              const config::ServoConfig& servo, const std::string& out, double duration_s,
                              const std::string& command);

}  // namespace fovea::hw
