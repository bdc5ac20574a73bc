// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/replay/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/recording/flight/config_changes.hpp"
#include "firmware/host/recording/flight/recorded_settings.hpp"

namespace fovea {
namespace {

using config::InputError;

std::optional<vision::Intrinsics> IntrinsicsOf(const flight::RecordedSettings& recorded) {
  if (!recorded.camera) {
    return std::nullopt;
  }
  const flight::RecordedCamera& camera = *recorded.camera;
  return vision::Intrinsics{
      camera.width_px, camera.height_px, camera.f_u_px, camera.f_v_px, camera.c_u_px, camera.c_v_px, {}};
}

class Keys {
 public:
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  explicit Keys(const flight::RecordedSettings& recorded) : intrinsics_(IntrinsicsOf(recorded)) {
    config::AddServoKeys(servo_, table_);
    for (const config::Key& key : table_.keys()) {
      known_.push_back(key.name);
    }
    config::AddTargetKeys(target_, table_);
    table_.Number("robot.speed_scale", speed_scale_, 0.0, 1.0, "", "");
    table_.ApplyRecorded(recorded.keys);
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
    return config::MakeServoConfig(settings, {"of the log", recorded.arm, {}}, recorded.X_EC,
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
  const flight::RecordedSettings recorded = flight::ReadSettings(log);
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
