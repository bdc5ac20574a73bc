// Whether the eye can be steered by. Two things tell that it cannot, whatever is wrong with it:
//
// - The target moves in the picture against what the hand's motion does to a scene, in x or in y, for a
// while:
//   with d_k the shift that the encoders predict between two measurements and s_k the one that is seen, along
//   one axis, a target at rest has  sum s_k d_k = sum d_k^2,  one that is followed 0, a mirrored picture
//   - sum d_k^2. A target that runs away does the same until the hand is as fast.
// - Steering does not help: the hand goes a long way, and the error gets no smaller.
//
// Then the servo holds, and a person has to ask for more.
#pragma once

#include <array>

#include "firmware/core/config/servo_config.hpp"

namespace fovea::estimate {

struct EyeWatch {
  // the picture against the hand
  bool has_last = false;
  model::Pose X_BC_last;                          // of the last measurement
  model::Vec3 p_CO_C_last = model::Vec3::Zero();  // the target's place in it [m]
  std::array<double, 2> predicted{};              // fading sum of d_k^2, in x and y
  std::array<double, 2> seen{};                   // and of s_k d_k
  // steering
  double least_error = 0.0;  // the smallest since the way is counted; 0: none yet
  double way = 0.0;          // of the camera since then [m]

  bool doubted = false;  // by either
};

// A measurement of the target at `p_CO_C` [m] by a camera at `X_BC`. Real-time: yes.
void WatchPicture(const config::PredictConfig& config, const model::Pose& X_BC, const model::Vec3& p_CO_C,
                  EyeWatch& watch) noexcept;

// A tick in which the servo steers: the feature's error as a share of its goal's size, and the camera's speed
// [m/s]. Real-time: yes.
void WatchSteering(const config::PredictConfig& config, double error, double speed, EyeWatch& watch) noexcept;

}  // namespace fovea::estimate
