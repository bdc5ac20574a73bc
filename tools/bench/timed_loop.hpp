// The servo's loop by the clock, and beside it a thread that only sleeps, as cyclictest does: when each
// period began, and when it was done.
#pragma once

#include <cstdint>
#include <vector>

#include "fovea/model/arm_model.hpp"

namespace fovea::bench {

struct Period {
  std::int32_t wake_ns = 0;      // from the deadline until the thread ran
  std::int32_t execute_ns = 0;   // from there until the command was written; 0 of a sleeper
  std::int32_t response_ns = 0;  // from the deadline until then
};

struct Block {
  std::vector<Period> periods;
  std::uint64_t overruns = 0;  // periods that began a whole one late
  long page_faults = 0;
  long voluntary_switches = 0;
  long involuntary_switches = 0;
};

// `periods` of 1 ms of the servo's loop, tracking a ball with an arm that obeys its model. In the calling
// thread.
Block RunServoBlock(const model::ArmModel& arm, int periods);

// `periods` of 1 ms of sleep to the next deadline and nothing else, by clock_nanosleep.
Block RunSleepBlock(int periods);

}  // namespace fovea::bench
