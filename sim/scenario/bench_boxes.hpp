// SPDX-License-Identifier: Apache-2.0
// The boxes of bench.boxes, which truly stand on the bench. The servo knows those of safety.boxes.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

// In B [m]. InputError: bench.boxes is not allowed.
std::vector<Eigen::AlignedBox3d> BenchBoxes(const Scenario& scenario);

// InputError: the arm starts in a box, or the target is a pushed ball, whose physics knows the table only.
void CheckBenchBoxes(const Scenario& scenario, const config::ServoConfig& servo);

}  // namespace fovea::sim
