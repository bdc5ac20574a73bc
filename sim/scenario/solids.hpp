// SPDX-License-Identifier: Apache-2.0
// What the arm must stay out of: the boxes of bench.boxes, which truly stand on the bench, and the planes and
// boxes of [safety], which the servo knows.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

// The boxes that truly stand on the bench, in B [m]. InputError: bench.boxes is not allowed.
std::vector<Eigen::AlignedBox3d> BenchBoxes(const Scenario& scenario);

// InputError: at the start the arm is inside a solid, known to `servo` or not, or the target's middle is
// inside a box on the bench; or there are such boxes and the target is a pushed ball, whose physics knows the
// table only.
void CheckSolids(const Scenario& scenario, const config::ServoConfig& servo);

}  // namespace fovea::sim
