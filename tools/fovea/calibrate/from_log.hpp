// SPDX-License-Identifier: Apache-2.0
// `fovea calibrate from-log`: refines mount, focal length and latency from the log of any run.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/config/toml_edit.hpp"

namespace fovea {

struct LogCalibration {
  beliefs::Findings findings;
  std::vector<config::NewValue> values;  // for section [camera]: the keys that the run tells completely
  std::vector<std::string> sigmas;       // "mount_xyz +- 0.12, 0.20, 0.15 mm"
  std::vector<std::string> unknown;      // "mount_xyz along x, z"
  std::string why_incomplete;            // what is wrong with the log's end, and where; "": nothing
};

// `log`: a log.mcap, or the folder of a run. config::InputError: it holds no run with a camera.
// std::runtime_error, naming the file: it cannot be read.
LogCalibration CalibrateFromLog(const std::string& log);

}  // namespace fovea
