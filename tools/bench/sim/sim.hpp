// SPDX-License-Identifier: Apache-2.0
// `fovea-bench sim`: the simulator's speed relative to real time, by picture size and rate.
#pragma once

namespace fovea::bench {

struct SimArguments {
  double seconds = 4.0;  // simulated time of each run
  bool shares = false;   // only the figures of SimShares
  bool json = false;
};

int RunSim(const SimArguments& arguments);

}  // namespace fovea::bench
