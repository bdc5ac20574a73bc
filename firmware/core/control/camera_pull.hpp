// SPDX-License-Identifier: Apache-2.0
// From a twist of the camera to a motion of the joints, damped near singularities.
#pragma once

#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

// (J J^T + damping I)^-1 J for the body Jacobian `J_C` [6 x num_joints] of the camera: its transpose takes a
// twist in axes of C to joint velocities, and a small motion to small changes of the joints. Real-time: yes.
[[nodiscard]] model::Mat6N CameraPull(const model::Mat6N& J_C) noexcept;

}  // namespace fovea::control
