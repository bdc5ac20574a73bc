// SPDX-License-Identifier: Apache-2.0
// `fovea-bench tick`: the time of one servo tick, by input and by stage.
#pragma once

#include <string>

namespace fovea::bench {

struct TickArguments {
  std::string robot = "panda";
  int runs = 40;              // random closed loops that are searched for the slowest tick
  bool instructions = false;  // also count instructions, under valgrind
  std::string count;          // internal: the mode whose ticks are counted in this process
  bool traced = false;        // internal: each counted tick adds its spans to a timeline
  bool recorded = false;      // internal: each counted tick goes through the flight recorder
  bool json = false;
};

int RunTick(const TickArguments& arguments);

}  // namespace fovea::bench
