// SPDX-License-Identifier: Apache-2.0
// Detects an eye (camera and detector) that cannot steer the arm, whatever its defect. There are two signs:
//
// - For a while the target moves in the picture, in x or in y, against the shift that the hand's motion gives
//   to a scene. Let d_k be the shift between two measurements that the encoders predict, and s_k the shift
//   that is seen, along one axis. A target at rest has  sum s_k d_k = sum d_k^2,  a followed target 0, a
//   mirrored picture  -sum d_k^2.  A target that runs away looks like that too until the hand is as fast.
//   Or it moves as predicted, but turned by 60 degrees or more: the camera is not mounted as configured. (A
//   target on a circle that the hand follows 37 to 60 degrees behind looks like that too; the servo
//   predicts.)
// - Steering does not help: the hand moves a long way, and the error does not become smaller.
//
// Then the servo holds until a person requests Track again. A wrong eye may lose the target before it is
// proved wrong: then a suspicion suffices.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"

namespace fovea::estimate {

struct EyeWatch {
  static constexpr std::int32_t kFewestShifts = 3;  // one fits any turn

  // the picture against the hand
  bool has_last = false;
  model::Pose X_BC_last;                          // at the last measurement
  model::Vec3 p_CO_C_last = model::Vec3::Zero();  // the target's place in it [m]
  std::array<double, 2> predicted{};              // fading sum of d_k^2, in x and y
  std::array<double, 2> seen{};                   // and of s_k d_k
  // The same without the shifts by the camera's turn about its axis and its motion along it, which a mount
  // that is turned about the axis leaves as they are: D_k and S_k.
  double predicted2 = 0.0;  // fading sum of |D_k|^2
  double seen2 = 0.0;       // of |S_k|^2
  double along = 0.0;       // of S_k . D_k
  double aside = 0.0;       // of D_k x S_k
  double by_axis2 = 0.0;    // of |s_k - S_k|^2
  std::int32_t shifts = 0;  // that counted, up to kFewestShifts
  // steering
  double least_error = 0.0;  // the smallest since `way` counts; 0: none yet
  double way = 0.0;          // travel of the camera since then [m]

  bool suspected = false;  // the picture seems to go against the hand, so far
  bool doubted = false;    // by one of the two

  // The scene has shifted in the picture, and as the hand's motion says.
  [[nodiscard]] bool IsTrusted() const noexcept { return shifts == kFewestShifts && !suspected && !doubted; }
};

// A measurement of the target at `p_CO_C` [m] by a camera at `X_BC`. Real-time: yes.
void WatchPicture(const config::PredictConfig& config, const model::Pose& X_BC, const model::Vec3& p_CO_C,
                  EyeWatch& watch) noexcept;

// A tick of steering. `error`: the feature's error relative to its goal's size; `speed`: of the camera [m/s].
// Real-time: yes.
void WatchSteering(const config::PredictConfig& config, double error, double speed, EyeWatch& watch) noexcept;

// Call when something else than the law has moved the hand: what the law does counts from here.
// Real-time: yes.
inline void ForgetSteering(EyeWatch& watch) noexcept {
  watch.least_error = 0.0;
  watch.way = 0.0;
}

}  // namespace fovea::estimate
