// How fast a task becomes joint velocities.
#pragma once

#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// The visual law for eight features: from s and L_s [8 x 6] to the camera's twist, as other libraries' do, by
// the pseudo-inverse (`visual_law_ns`) and damped where directions are weak, two of six here
// (`visual_law_damped_ns`); and on to the velocities of the arm's joints with the posture in what is free
// (`visual_law_joints_...`); and those with all limits inside. The servo's own code in each; ns per call over
// random postures and squares.
std::vector<Figure> LawSpeed(const model::ArmModel& arm);

}  // namespace fovea::bench
