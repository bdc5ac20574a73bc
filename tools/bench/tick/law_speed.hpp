// SPDX-License-Identifier: Apache-2.0
// Speed of the visual law and of its resolution to joint velocities.
#pragma once

#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// The servo's own code for eight features, in ns per call over random postures and squares:
//   visual_law_ns              from s and L_s [8 x 6] to the camera's twist, by the pseudo-inverse
//   visual_law_damped_ns       the same, damped in weak directions: two of six here
//   visual_law_joints_[...]ns  from s and L_s to joint velocities, with the posture in the free directions
//   resolve_constrained_ns     from the task to joint velocities within all limits
std::vector<Figure> LawSpeed(const model::ArmModel& arm);

}  // namespace fovea::bench
