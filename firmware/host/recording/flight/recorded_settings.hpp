// SPDX-License-Identifier: Apache-2.0
// What a log says of its run beside the ticks: its keys and its camera.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace fovea::flight {

struct RecordedCamera {
  int width_px = 0;
  int height_px = 0;
  double f_u_px = 0.0;
  double f_v_px = 0.0;
  double c_u_px = 0.0;
  double c_v_px = 0.0;
};

struct RecordedSettings {
  std::map<std::string, std::string> keys;  // by the names of the program that wrote the log
  std::optional<RecordedCamera> camera;
};

// std::runtime_error, naming the file: it cannot be read.
RecordedSettings ReadSettings(const std::filesystem::path& log);

}  // namespace fovea::flight
