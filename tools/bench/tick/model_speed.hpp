// SPDX-License-Identifier: Apache-2.0
// Speed of the arm's model and of KDL, in the same run.
#pragma once

#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// Poses, Jacobian, M, C dq and g, inverse dynamics: ns per call over random states. Our functions and KDL's
// run in turns, so a disturbance affects both.
std::vector<Figure> ModelSpeed(const model::ArmModel& arm);

}  // namespace fovea::bench
