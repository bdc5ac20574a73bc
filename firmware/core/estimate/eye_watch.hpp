// SPDX-License-Identifier: Apache-2.0
// Detects an eye (camera and detector) that cannot steer the arm, whatever its defect. There are two signs:
//
// - For a while the target moves in the picture, in x or in y, against the shift that the hand's motion gives
//   to a scene. Let d_k be the shift between two measurements that the encoders predict, and s_k the shift
//   that is seen, along one axis. A target at rest has  sum s_k d_k = sum d_k^2,  a followed target 0, a
//   mirrored picture  -sum d_k^2.  A target that runs away looks like that too until the hand is as fast.
// - Steering does not help: the hand moves a long way, and the error does not become smaller.
//
// Then the servo holds until a person requests Track again.
#pragma once

#include <array>

#include "firmware/core/config/servo_config.hpp"

namespace fovea::estimate {

struct EyeWatch {
  // the picture against the hand
  bool has_last = false;
  model::Pose X_BC_last;                          // at the last measurement
  model::Vec3 p_CO_C_last = model::Vec3::Zero();  // the target's place in it [m]
  std::array<double, 2> predicted{};              // fading sum of d_k^2, in x and y
  std::array<double, 2> seen{};                   // and of s_k d_k
  // steering
  double least_error = 0.0;  // the smallest since `way` counts; 0: none yet
  double way = 0.0;          // travel of the camera since then [m]

  bool doubted = false;  // by one of the two
};

// A measurement of the target at `p_CO_C` [m] by a camera at `X_BC`. Real-time: yes.
void WatchPicture(const config::PredictConfig& config, const model::Pose& X_BC, const model::Vec3& p_CO_C,
                  EyeWatch& watch) noexcept;

// A tick of steering. `error`: the feature's error relative to its goal's size; `speed`: of the camera [m/s].
// Real-time: yes.
void WatchSteering(const config::PredictConfig& config, double error, double speed, EyeWatch& watch) noexcept;

}  // namespace fovea::estimate
