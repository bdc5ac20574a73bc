// How fast a task becomes joint velocities.
#pragma once

#include <vector>

#include "figure.hpp"
#include "fovea/model/arm_model.hpp"

namespace fovea::bench {

// The visual law for eight features, with the damped pseudo-inverse of its Jacobian; and with all limits
// inside: ns per call over random postures.
std::vector<Figure> LawSpeed(const model::ArmModel& arm);

}  // namespace fovea::bench
