// What of this machine bears on the timing of a thread.
#pragma once

#include <string>
#include <vector>

namespace fovea::bench {

struct MachineFacts {
  std::string kernel;
  std::string processor;
  int cores = 0;
  std::vector<std::string> limits;  // one line for each thing that is not as a real-time machine wants it
};

// `missing`: what the measured thread asked for in vain.
MachineFacts LookAtMachine(const std::vector<std::string>& missing);

}  // namespace fovea::bench
