// SPDX-License-Identifier: Apache-2.0
// The simulator's arm that a log is compared with.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/robots/robot.hpp"
#include "sim/world/world.hpp"
#include "tools/fovea/compare/recorded_run.hpp"

namespace fovea::compare {

struct SimulatedArm {
  robots::Robot robot;                              // as numbers, with its load
  model::Vec3 load_centre_E = model::Vec3::Zero();  // where that load is believed to be [m]
  sim::WorldConfig world;  // the same for the physics: no target, noise, fault or wrong belief
};

// The arm that the log's configuration describes, or that of the scenario `scenario` if it is not empty, but
// with the keys of [arm] in `assignments` ("arm.load_mass=0.5"). The robot's own controller does not know of
// these: it compensates the weight and friction of the arm before. InputError: a key that is not allowed, no
// such arm, or not the arm of the log.
SimulatedArm MakeSimulatedArm(const RecordedRun& run, const std::string& scenario,
                              const std::vector<std::string>& assignments);

}  // namespace fovea::compare
