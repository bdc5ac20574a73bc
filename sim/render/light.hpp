// SPDX-License-Identifier: Apache-2.0
// The bench's light: a bright ceiling, a darker floor, and one sun through a high window.
#pragma once

#include <Eigen/Core>

namespace fovea::sim {

// Brightness of a white surface per colour, at gain 1.
inline const Eigen::Vector3f kSkyFromAbove(0.46F, 0.48F, 0.50F);
inline const Eigen::Vector3f kSkyFromBelow(0.26F, 0.25F, 0.24F);
inline const Eigen::Vector3f kSunLight(0.66F, 0.64F, 0.60F);  // facing the sun
// Unit vector towards the sun, in B.
inline const Eigen::Vector3f kSun_B = Eigen::Vector3f(-0.35F, -0.55F, 1.0F).normalized();

}  // namespace fovea::sim
