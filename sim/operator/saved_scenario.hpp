// SPDX-License-Identifier: Apache-2.0
// Writes the present state of a run as a scenario that begins there.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>

#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

struct PresentState {
  Truth truth;                          // the arm and the target
  bool target_touched = false;          // the target rests; otherwise the scenario still moves it
  std::map<std::string, double> tuned;  // keys that were changed in motion, with their present values
  FaultSettings faults;                 // in the run's time
};

// The text of a scenario file: the keys of the run's scenario that differ from the defaults, changed to begin
// at `present`, with the same [truth]. Faults keep their remaining times. A target that the scenario still
// moves begins its path anew; a comment in the file says so. InputError: a tuned key is no key of a scenario.
std::string SaveScenario(const RunDescription& about, const PresentState& present);

}  // namespace fovea::sim
