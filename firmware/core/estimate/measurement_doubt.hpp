// What a wrong calibration can make of a measurement: by how much the camera's pose, as the measurement sees
// it, may disagree with what the filter took in a moment before.
//
// A wrong mount, a wrong stamp or a wrong scale puts the target in the wrong place, but in the same wrong
// place for as long as the hand moves alike: the filter takes the error in. What it cannot take in is the
// error's change. With delta the mount's error as a twist of C, V the camera's twist, dt the stamp's error, c
// the target in C, sigma its relative error in scale, and 1 -> 2 the camera's way since a moment before:
//
//   (I - Ad(X_C2C1)) delta,   (V_2 - Ad(X_C2C1) V_1) dt,   (c - R_C2C1 c_1) sigma
//
// The sum of their covariances is for the gate alone (a consider covariance: Schmidt, Application of
// state-space methods to navigation problems, 1966): the errors are no noise that a mean would take away, so
// the gain knows nothing of them.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/joint_history.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::estimate {

// Covariance of the camera's pose as a twist of C, [v; w] [m, rad], for a measurement at `stamp_ns`, when it
// was at `X_BC`. Zero where the history does not reach back. Real-time: yes.
[[nodiscard]] model::Mat6 MeasurementDoubt(const config::ServoConfig& config, const JointHistory& history,
                                           std::int64_t stamp_ns, const model::Pose& X_BC) noexcept;

}  // namespace fovea::estimate
