// SPDX-License-Identifier: Apache-2.0
// Twists [v; w] of one rigid body in its different frames (THEORY B4).
#pragma once

#include <array>

#include "firmware/core/model/types.hpp"

namespace fovea::model {

// The twist of A's origin in axes of A, for `V_B` that of B's origin in axes of B, where A and B are fixed to
// one body with B at `X_AB`: V_A = Ad(X_AB) V_B. Real-time: yes.
[[nodiscard]] Vec6 ShiftTwist(const Pose& X_AB, const Vec6& V_B) noexcept;

// The end effector's twist in axes of B, from the camera's `V_BC_C` [m/s, rad/s]. `x_BE`: position [m] and
// quaternion (w, x, y, z) of the end effector, 7 numbers; `X_EC`: pose of the camera in the hand, lever arm
// included. False, with `V_BE_B` unchanged, if the quaternion is invalid or an argument is not finite.
// Real-time: yes.
[[nodiscard]] bool CameraToBaseTwist(const std::array<double, 7>& x_BE, const Pose& X_EC, const Vec6& V_BC_C,
                                     Vec6& V_BE_B) noexcept;

}  // namespace fovea::model
