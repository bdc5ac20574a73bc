// A limit on the motion that keeps a disc's face to the camera.
//
// A disc says where it is and how far, not how the camera is turned about it: three directions are free, and
// the posture and its like may use them until the disc is seen edge-on, where nothing finds it. So its tilt
// against the line of sight, the angle between its normal and the ray to its centre, may approach its largest
// only so fast, and past it no further. Turning the camera about itself does not tilt it; only the way round
// it does.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/guard_config.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::barriers {

// Its quantity is n.r, the cosine of the tilt, with the margin guard.view.disc_cosine_min. None where that is
// 0: any view will do. `p_CO_C` [m] the disc's centre, not at the camera; `normal_C` of length 1, away from
// the camera as one looks at the disc's painted side; `J_C` body Jacobian of the camera. Real-time: yes.
[[nodiscard]] Barrier DiscTiltBarrier(const config::GuardConfig& guard, const model::Vec3& p_CO_C,
                                      const model::Vec3& normal_C, const model::Mat6N& J_C) noexcept;

}  // namespace fovea::barriers
