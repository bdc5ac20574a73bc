// SPDX-License-Identifier: Apache-2.0
// All settings of the servo. Fixed after Init, except for the keys that may change in motion (tuning.hpp).
// Each struct has its own file, with the list of its fields: key, unit, range, meaning (fields.hpp).
#pragma once

#include "firmware/core/config/feature_fields.hpp"
#include "firmware/core/config/guard_config.hpp"
#include "firmware/core/config/law_config.hpp"
#include "firmware/core/config/load_config.hpp"
#include "firmware/core/config/motion_law_config.hpp"
#include "firmware/core/config/move_config.hpp"
#include "firmware/core/config/predict_config.hpp"
#include "firmware/core/config/safety_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/arm_model.hpp"

namespace fovea::config {

struct ServoConfig {
  model::ArmModel arm;
  model::Pose X_EC;  // pose of the camera in the hand
  features::TargetFeature feature;
  bool auto_track = false;
  PredictConfig predict;
  LawConfig law;
  MoveConfig move;
  MotionLawConfig motion_law;
  GuardConfig guard;
  SafetyConfig safety;
  LoadConfig load;
};

inline constexpr Field kAutoTrackField{"servo.auto_track", "", "go to Track as soon as the target is known"};

// Calls `visit(name, fields)` for each section except the arm, in the order of messages and logs.
// `fields(visitor)` visits the section's fields.
template <class Visit, Struct<ServoConfig> Config>
void EachSection(Config& c, const Visit& visit) noexcept {
  visit("mount", [&c](auto& v) {
    v.Derived({"camera.mount_rpy_deg"}, c.X_EC.R, -1.0, 1.0);
    v.Derived({"camera.mount_xyz"}, c.X_EC.p, -1e6, 1e6);
  });
  visit("feature", [&c](auto& v) { Fields(v, c.feature); });
  visit("auto_track", [&c](auto& v) { v.Flag(kAutoTrackField, c.auto_track); });
  visit("predict", [&c](auto& v) { Fields(v, c.predict); });
  visit("law", [&c](auto& v) { Fields(v, c.law); });
  visit("move", [&c](auto& v) { Fields(v, c.move); });
  visit("motion_law", [&c](auto& v) { Fields(v, c.motion_law); });
  visit("guard", [&c](auto& v) { Fields(v, c.guard); });
  visit("safety", [&c](auto& v) { Fields(v, c.safety); });
  visit("load", [&c](auto& v) { Fields(v, c.load); });
}

template <class Visitor, Struct<ServoConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  EachSection(c, [&v](const char*, const auto& fields) { fields(v); });
}

}  // namespace fovea::config
