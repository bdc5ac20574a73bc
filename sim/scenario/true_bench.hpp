// SPDX-License-Identifier: Apache-2.0
// What is true of a run's bench: the scenario's values, except where [truth] says otherwise.
#pragma once

#include "sim/scenario/run_description.hpp"
#include "sim/truth/truth_draw.hpp"

namespace fovea::sim {

// Draws the true values. `run` has robot, pinhole and lens as the servo believes them, `believed` is the
// believed robot without a load. Fills in run.bench, run.eye, run.robot_truth, run.stamps and run.truth.
// Returns the true robot with its true load. InputError: a value of [truth] is not allowed.
SimRobot DrawTruth(const SimRobot& believed, RunDescription& run);

}  // namespace fovea::sim
