// How fast the arm's model is, beside KDL's in the same run.
#pragma once

#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// Poses, Jacobian, M, C dq and g, inverse dynamics: ns per call over random states; ours and KDL's are called
// in turns, so that what disturbs one disturbs the other.
std::vector<Figure> ModelSpeed(const model::ArmModel& arm);

}  // namespace fovea::bench
