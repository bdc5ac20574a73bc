// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/replay/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/recording/flight/config_changes.hpp"
#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/image.pb.h"

namespace fovea {
namespace {

using config::InputError;

// The keys and the camera that a log records for its run.
struct Recorded {
  std::map<std::string, std::string> keys;
  std::optional<vision::Intrinsics> intrinsics;
};

Recorded ReadRecorded(const std::filesystem::path& log) {
  Recorded recorded;
  log::McapVisitor visitor;
  visitor.on_metadata = [&](std::string_view name, const std::map<std::string, std::string>& entries) {
    if (name == "configuration") {
      recorded.keys = entries;
    }
  };
  visitor.on_message = [&](const log::McapMessage& message) {
    foxglove::CameraCalibration camera;
    if (message.topic == log::kCalibrationTopic &&
        camera.ParseFromArray(message.data.data(), static_cast<int>(message.data.size())) &&
        camera.k_size() == 9) {
      recorded.intrinsics = {static_cast<int>(camera.width()),
                             static_cast<int>(camera.height()),
                             camera.k(0),
                             camera.k(4),
                             camera.k(2),
                             camera.k(5),
                             {}};
    }
  };
  log::ReadMcap(log, visitor);
  return recorded;
}

class Keys {
 public:
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  explicit Keys(const Recorded& recorded) : intrinsics_(recorded.intrinsics) {
    config::AddServoKeys(servo_, table_);
    const std::size_t of_servo = table_.keys().size();
    config::AddTargetKeys(target_, table_);
    table_.Number("robot.speed_scale", speed_scale_, 0.0, 1.0, "", "");
    std::map<std::string, std::string> values;
    for (const auto& [name, text] : recorded.keys) {
      values[table_.NameToday(name)] = text;
    }
    for (std::size_t i = 0; i < table_.keys().size(); ++i) {
      const config::Key& key = table_.keys()[i];
      const auto text = values.find(key.name);
      if (text != values.end() && text->second != key.default_text) {
        table_.Apply(config::ParseAssignment(key.name + "=" + text->second));
      }
      if (i < of_servo) {
        known_.push_back(key.name);
      }
    }
  }

  void Set(const std::string& assignment) {
    const config::Setting setting = config::ParseAssignment(assignment);
    if (std::find(known_.begin(), known_.end(), setting.key) == known_.end()) {
      throw InputError(fmt::format("--set {}: a replay accepts the keys of [servo] and [safety]{}",
                                   setting.key, config::DidYouMean(setting.key, known_)));
    }
    table_.Apply(setting);
  }

  [[nodiscard]] config::ServoConfig Make(const config::ServoConfig& recorded) const {
    config::ServoSettings settings = servo_;
    config::ScaleSpeed(speed_scale_, settings);
    settings.keep_in_view = settings.keep_in_view && intrinsics_.has_value();
    return config::MakeServoConfig(settings, {"of the log", recorded.arm}, recorded.X_EC,
                                   intrinsics_.value_or(vision::Intrinsics{}), target_);
  }

 private:
  std::optional<vision::Intrinsics> intrinsics_;
  config::ServoSettings servo_;
  config::TargetSettings target_;
  double speed_scale_ = 1.0;
  config::KeyTable table_;
  std::vector<std::string> known_;
};

}  // namespace

std::function<config::ServoConfig(const config::ServoConfig&)> ChangeOf(
    const std::filesystem::path& log, const std::vector<std::string>& assignments) {
  const Recorded recorded = ReadRecorded(log);
  return [recorded, assignments](const config::ServoConfig& config) {
    const Keys before(recorded);
    Keys after(recorded);
    for (const std::string& assignment : assignments) {
      after.Set(assignment);
    }
    return flight::WithChanges(config, before.Make(config), after.Make(config));
  };
}

}  // namespace fovea
