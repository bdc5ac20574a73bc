// Reads from a log what a replay needs, in order: what the servo was told, its ticks, and its keyframes.
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

// Any may be empty.
struct TickVisitor {
  std::function<void(const std::string& name, const std::map<std::string, std::string>&)> on_metadata;
  std::function<void(const log::ServoConfiguration&)> on_configuration;
  std::function<void(const log::Keyframe&)> on_keyframe;  // before its tick
  // With the measurement that it took, if it took one. A tick whose measurement is not in the log is left
  // out, as one that is not there itself.
  std::function<void(const log::Tick&, const hal::FeatureMeasurement&)> on_tick;
  std::function<void(const log::McapMessage&)> on_other;  // of any other topic
};

// std::runtime_error, naming the file: it cannot be read, or a message of it cannot be.
log::McapEnd ReadTicks(const std::filesystem::path& path, const TickVisitor& visitor);

// The log of a run's folder: log.mcap, or what was written of it when the run did not end; a file's path as
// it is.
std::filesystem::path LogIn(const std::filesystem::path& log_or_folder);

}  // namespace fovea::flight
