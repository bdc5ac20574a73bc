// SPDX-License-Identifier: Apache-2.0
// The keys of sections [servo] and [safety], the same for the simulator and for hardware.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/target_keys.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea::config {

// The values of the keys, before robot, camera mount and target are known.
struct ServoSettings {
  ServoConfig config;
  std::string learn;                                // quantities, separated by commas; see LearntOf
  std::vector<double> goal{0.0, 0.0, 0.40};         // p_CO_C_star [m]
  std::vector<double> goal_rpy_deg{0.0, 0.0, 0.0};  // R_CO_star, of square and triangle
  std::string feature = "auto";                     // the target's usual one, or the law's
  std::string law = "auto";                         // the feature's
  bool keep_in_view = true;
  double view_margin_px = 10.0;
  double disc_tilt_max = 1.05;  // [rad]
  double stuck_shift_px = 2.0;
  std::vector<double> target_region{-3.0, -3.0, -3.0, 3.0, 3.0, 3.0};  // low x, y, z, high x, y, z [m]
  std::vector<double> posture;                                         // empty: the robot's ready posture
  double camera_radius = 0.03;                                         // [m]
  std::vector<double> tools;   // capsules: p_EA, p_EB, radius of each [m]
  std::vector<double> planes;  // n_x, n_y, n_z, d of each
  std::vector<double> boxes;   // low x, y, z, high x, y, z of each
  std::vector<double> k_p;     // per joint; empty: omega_n^2 times the inertia in the ready posture
  std::vector<double> k_v;     // per joint; empty: by zeta, from k_p and that inertia
};

// The settings must outlive the table.
void AddServoKeys(ServoSettings& settings, KeyTable& keys);

// What the servo shall find out and apply while it runs.
struct LearntQuantities {
  bool latency = false;
  bool payload = false;
};
// InputError: servo.learn has an unknown word.
LearntQuantities LearntOf(const ServoSettings& settings);

// Scales gains and speed limits by robot.speed_scale.
void ScaleSpeed(double scale, ServoSettings& settings);

// Boxes from the numbers of `key`: low x, y, z, high x, y, z of each [m]. InputError, which names the key: no
// whole number of boxes, or a low corner that is not below its high one.
std::vector<Box> MakeBoxes(const std::string& key, const std::vector<double>& corners);

struct NamedArm {
  std::string name;  // for messages
  model::ArmModel model;
  model::Load load;  // part of the model already
};

// The servo's whole configuration for `arm`, with the camera at `X_EC`. InputError: a posture that does not
// fit the arm, a feature that the target does not have, or anything that ServoTask::Init refuses.
ServoConfig MakeServoConfig(const ServoSettings& settings, const NamedArm& arm, const model::Pose& X_EC,
                            const vision::Intrinsics& intrinsics, const TargetSettings& target);

}  // namespace fovea::config
