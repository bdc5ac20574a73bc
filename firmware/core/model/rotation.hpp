// SPDX-License-Identifier: Apache-2.0
// Rotations as vectors (axis times angle), and back. Uses our own sin, cos and atan2, so that bits agree.
#pragma once

#include <array>

#include "firmware/core/model/types.hpp"

namespace fovea::model {

// The turn `phi` [rad] as a matrix: R = exp([phi]x). Real-time: yes.
[[nodiscard]] Mat3 RotationOf(const Vec3& phi) noexcept;

// The shortest turn whose matrix is `R` [rad], at most pi long. (Shepperd, Quaternion from rotation matrix,
// 1978, for the quaternion.) Real-time: yes.
[[nodiscard]] Vec3 RotationVector(const Mat3& R) noexcept;

// The unit quaternion (w, x, y, z) of the turn `R`, w >= 0. (Shepperd, as above.) Real-time: yes.
[[nodiscard]] std::array<double, 4> QuaternionOf(const Mat3& R) noexcept;

// The turn of the quaternion (w, x, y, z) of any length but 0 (THEORY B4). False, with `R` unchanged, if its
// length is 0, out of range or not finite. Real-time: yes.
[[nodiscard]] bool RotationOfQuaternion(const std::array<double, 4>& quaternion, Mat3& R) noexcept;

// How the angular velocity follows from dphi/dt: w = A(phi) dphi/dt for R = exp([phi]x), w in the axes that R
// turns from. `TurnRateMatrix` is A; `TurnRateInverse` its inverse, for |phi| < 2 pi. Real-time: yes.
[[nodiscard]] Mat3 TurnRateMatrix(const Vec3& phi) noexcept;
[[nodiscard]] Mat3 TurnRateInverse(const Vec3& phi) noexcept;

}  // namespace fovea::model
