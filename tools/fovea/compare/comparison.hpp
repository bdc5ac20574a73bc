// SPDX-License-Identifier: Apache-2.0
// A log compared with the simulator's arm: all figures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/report/envelope.hpp"
#include "tools/fovea/compare/causes.hpp"
#include "tools/fovea/compare/player.hpp"

namespace fovea::compare {

// Of one quantity of one joint.
struct Spread {
  double rms = 0.0;
  double worst = 0.0;    // the value furthest from 0
  double worst_s = 0.0;  // its time since the first state
};

struct JointFigures {
  std::string name;
  bool slides = false;  // m and N instead of rad and Nm
  Spread q;             // predicted less recorded
  Spread dq;
  Spread ddq;
  Spread torque;  // that the recorded arm had beyond the simulated one
};

struct Comparison {
  int window_ms = 0;
  int ticks = 0;  // compared
  double end_s = 0.0;
  std::vector<JointFigures> joints;
  Causes causes;
  std::vector<Lack> windows;
  report::Envelope deviations{0, 0};  // of positions, for a plot; a column for each joint
};

// `window_ms`: even. config::InputError: no window's worth of states follow each other without a gap.
Comparison Compare(const std::filesystem::path& log, const RecordedRun& run, const SimulatedArm& arm,
                   int window_ms);

}  // namespace fovea::compare
