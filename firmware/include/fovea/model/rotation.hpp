// Rotations as vectors: axis times angle, and back. By our own sin, cos and atan2, so that bits agree.
#pragma once

#include "fovea/model/types.hpp"

namespace fovea::model {

// The turn `phi` [rad] as a matrix: R = exp([phi]x). Real-time: yes.
[[nodiscard]] Mat3 RotationOf(const Vec3& phi) noexcept;

// The shortest turn whose matrix is `R` [rad], at most pi long. (Shepperd, Quaternion from rotation matrix,
// 1978, for the way to the quaternion.) Real-time: yes.
[[nodiscard]] Vec3 RotationVector(const Mat3& R) noexcept;

// How the angular velocity follows from dphi/dt: w = A(phi) dphi/dt for R = exp([phi]x), w in the axes that R
// turns from. `TurnRateMatrix` is A; `TurnRateInverse` its inverse, for |phi| < 2 pi. Real-time: yes.
[[nodiscard]] Mat3 TurnRateMatrix(const Vec3& phi) noexcept;
[[nodiscard]] Mat3 TurnRateInverse(const Vec3& phi) noexcept;

}  // namespace fovea::model
