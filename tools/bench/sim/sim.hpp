// `fovea-bench sim`: how much faster than the clock the simulator runs, by picture size and rate.
#pragma once

namespace fovea::bench {

struct SimArguments {
  double seconds = 4.0;  // simulated, of each run
  bool shares = false;   // only what the time goes to
  bool json = false;
};

int RunSim(const SimArguments& arguments);

}  // namespace fovea::bench
