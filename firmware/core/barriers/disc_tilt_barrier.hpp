// SPDX-License-Identifier: Apache-2.0
// A motion limit that keeps a disc's face towards the camera.
//
// A disc's feature controls the camera's direction and distance to the disc, not its orientation. Three
// directions stay free, and the null-space motion may use them until the camera sees the disc edge-on and the
// detector loses it. Therefore the disc's tilt (the angle between its normal and the ray to its centre) may
// approach its maximum only at a limited speed, and must not grow beyond it. A camera that rotates about
// itself does not change the tilt; only a motion around the disc does.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/guard_config.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::barriers {

// h is n.r, the cosine of the tilt; its margin is guard.view.disc_cosine_min. Inactive if that is 0. `p_CO_C`
// [m]: the disc's centre, not at the camera. `normal_C`: of length 1, pointing away from a camera that sees
// the disc's painted side. `J_C`: body Jacobian of the camera. Real-time: yes.
[[nodiscard]] Barrier DiscTiltBarrier(const config::GuardConfig& guard, const model::Vec3& p_CO_C,
                                      const model::Vec3& normal_C, const model::Mat6N& J_C) noexcept;

}  // namespace fovea::barriers
