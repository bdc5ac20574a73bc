// SPDX-License-Identifier: Apache-2.0
// Reads the data for a replay from a log, in order: the servo's configuration, its ticks and its keyframes.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::log {
class Keyframe;
class ServoConfiguration;
class Tick;
}  // namespace fovea::log

namespace fovea::flight {

// Any function may be empty.
struct TickVisitor {
  std::function<void(const std::string& name, const std::map<std::string, std::string>&)> on_metadata;
  std::function<void(const log::ServoConfiguration&)> on_configuration;
  std::function<void(const log::Keyframe&)> on_keyframe;  // before its tick
  // With the measurement that the tick took, if any. A tick whose measurement is missing in the log is left
  // out, like a missing tick.
  std::function<void(const log::Tick&, const hal::FeatureMeasurement&)> on_tick;
  std::function<void(const log::McapMessage&)> on_other;  // of any other topic
};

// std::runtime_error, naming the file: the file or one of its messages cannot be read.
log::McapEnd ReadTicks(const std::filesystem::path& path, const TickVisitor& visitor);

// The log of a run's folder: log.mcap, or the partial log if the run did not end. Returns the path of a file
// unchanged.
std::filesystem::path LogIn(const std::filesystem::path& log_or_folder);

}  // namespace fovea::flight
