// `fovea-bench tick`: what one tick of the servo costs, on which input, and in which stage.
#pragma once

#include <string>

namespace fovea::bench {

struct TickArguments {
  std::string robot = "panda";
  int runs = 40;              // random ones in which the worst input is searched
  bool instructions = false;  // also count them, under valgrind
  std::string count;          // internal: the mode whose ticks are counted in this process
  bool traced = false;        // internal: and each of them leaves its spans on a timeline
  bool recorded = false;      // internal: and each of them goes through the flight recorder
  bool json = false;
};

int RunTick(const TickArguments& arguments);

}  // namespace fovea::bench
