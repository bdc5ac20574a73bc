// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/servo_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/host/config/field_keys.hpp"
#include "firmware/host/config/input_error.hpp"

namespace fovea::config {
namespace {

constexpr std::size_t kMostTools = 6;

// A list of numbers, with the unit and the meaning of its field.
FieldKeys::Add List(std::vector<double>& values, std::size_t size_min, std::size_t size_max, double min,
                    double max) {
  return [&values, size_min, size_max, min, max](KeyTable& keys, const Field& field) {
    keys.Numbers(field.key, values, size_min, size_max, min, max, field.unit, field.meaning);
  };
}

FieldKeys::Add Number(double& value, double min, double max) {
  return [&value, min, max](KeyTable& keys, const Field& field) {
    keys.Number(field.key, value, min, max, field.unit, field.meaning);
  };
}

// Binds the keys from which fields of the servo's settings are derived.
void BindDerived(ServoSettings& s, FieldKeys& keys) {
  keys.Bind("servo.target_region", List(s.target_region, 6, 6, -100.0, 100.0));
  keys.Bind("servo.stuck_shift_px", Number(s.stuck_shift_px, 0.5, 1000.0));
  keys.Bind("servo.law", [&s](KeyTable& table, const Field& field) {
    std::vector<std::string> laws{"auto"};
    laws.insert(laws.end(), kLawNames.begin(), kLawNames.end());
    table.Choice(field.key, s.law, laws, field.meaning);
  });
  keys.Bind("servo.posture", List(s.posture, 1, model::kMaxJoints, -1e4, 1e4));
  keys.Bind("servo.k_p", List(s.k_p, 1, model::kMaxJoints, 0.0, 1e6));
  keys.Bind("servo.k_v", List(s.k_v, 1, model::kMaxJoints, 0.0, 1e6));
  keys.Bind("safety.planes", List(s.planes, 0, 4 * Obstacles::kMost, -100.0, 100.0));
  keys.Bind("safety.boxes", List(s.boxes, 0, 6 * Obstacles::kMost, -100.0, 100.0));
  keys.Bind("safety.tools", List(s.tools, 0, 7 * kMostTools, -10.0, 10.0));
  keys.Bind("safety.keep_in_view", [&s](KeyTable& table, const Field& field) {
    table.Flag(field.key, s.keep_in_view, field.meaning);
  });
  keys.Bind("safety.view_margin_px", Number(s.view_margin_px, 0.0, 1000.0));
  keys.Bind("safety.disc_tilt_max", Number(s.disc_tilt_max, 0.1, std::numbers::pi / 2.0));
}

void AddFeatureKeys(ServoSettings& s, KeyTable& keys) {
  std::vector<std::string> forms{"auto"};
  forms.insert(forms.end(), features::kFormNames.begin(), features::kFormNames.end());
  keys.Choice(
      "servo.feature", s.feature, forms,
      "feature that the law controls; auto: sphere P/R, circle x, y, D/Z, the square's corners, the "
      "triangle's pose, or what servo.law needs; also allowed: circle for a sphere, side and corner_side for "
      "a square (4 of 6 degrees of freedom), pose and corners for square and triangle, pose and hybrid for "
      "all");
  keys.Flag("servo.hold_orientation", s.config.feature.hold_orientation,
            "also keep the camera's orientation as it was when tracking began; sphere, circle, side");
  keys.Numbers("servo.goal", s.goal, 3, 3, -10.0, 10.0, "m",
               "goal position of the target's centre in camera axes: x right, y down, z forward");
  keys.Numbers(
      "servo.goal_rpy_deg", s.goal_rpy_deg, 3, 3, -360.0, 360.0, "deg",
      "goal orientation of a square or triangle: roll, pitch, yaw about fixed camera axes; 0: it faces the "
      "camera");
}

}  // namespace

void AddServoKeys(ServoSettings& settings, KeyTable& keys) {
  FieldKeys fields(keys);
  BindDerived(settings, fields);
  ServoConfig& c = settings.config;
  fields.Flag(kAutoTrackField, c.auto_track);
  AddFeatureKeys(settings, keys);
  Fields(fields, c.law);
  Fields(fields, c.motion_law);
  Fields(fields, c.predict);
  Fields(fields, c.move);
  Fields(fields, c.load);
  keys.Text("servo.learn", settings.learn,
            "what the servo finds out and applies while it runs, separated by commas: latency "
            "(servo.stamp_offset), payload (servo.load_offset); needs a camera");
  Fields(fields, c.guard);
  keys.Number("safety.camera_radius", settings.camera_radius, 0.0, 1.0, "m",
              "the camera is guarded as a capsule of this radius from the flange to its lens; 0: unguarded");
  Fields(fields, c.safety);
  keys.Renamed("safety.carry_load", "safety.carried_torque_fraction");
  keys.Renamed("servo.interaction", "servo.law");
  keys.Renamed("safety.face_tilt_max", "safety.disc_tilt_max");
  keys.Renamed("safety.hand_clearance", "safety.self_clearance");
  keys.Renamed("safety.link_radius", "safety.link_clearance");
}

LearntQuantities LearntOf(const ServoSettings& settings) {
  LearntQuantities learnt;
  std::istringstream words(settings.learn);
  for (std::string word; std::getline(words, word, ',');) {
    const std::size_t begin = word.find_first_not_of(' ');
    word = begin == std::string::npos ? "" : word.substr(begin, word.find_last_not_of(' ') + 1 - begin);
    if (word == "latency") {
      learnt.latency = true;
    } else if (word == "payload") {
      learnt.payload = true;
    } else {
      throw InputError(fmt::format(
          "servo.learn = \"{}\" is not allowed: \"{}\" is none of latency, payload, separated by commas{}",
          settings.learn, word, DidYouMean(word, {"latency", "payload"})));
    }
  }
  return learnt;
}

void ScaleSpeed(double scale, ServoSettings& settings) {
  settings.config.law.lambda *= scale;
  settings.config.law.lambda_near *= scale;
  settings.config.guard.joint_velocity_fraction *= scale;
  double& speed = settings.config.guard.cartesian_speed;
  double& turn = settings.config.guard.rotation_speed;
  speed = std::max(scale * speed, kLeastCartesianSpeed);  // the least that Init allows
  turn = std::max(scale * turn, kLeastRotationSpeed);
}

}  // namespace fovea::config
