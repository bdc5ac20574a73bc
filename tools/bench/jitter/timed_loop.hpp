// The servo's loop by the clock, and beside it a thread that only sleeps, as cyclictest does: when each
// period began, and when it was done.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/task/stage_probe.hpp"
#include "tools/bench/jitter/eye_chain.hpp"

namespace fovea::bench {

struct Period {
  std::int64_t deadline_ns = 0;    // in CLOCK_MONOTONIC
  std::int32_t wake_ns = 0;        // from the deadline until the thread ran
  std::int32_t off_period_ns = 0;  // how far from 1 ms after the wake-up before; 0 of a block's first
  std::int32_t execute_ns = 0;     // from the wake-up until the command was written; 0 of a sleeper
  std::int32_t response_ns = 0;    // from the deadline until then
  // Of execute_ns, by stage of the tick; reading the arm counts as the first one's.
  std::array<std::int32_t, task::kStageNames.size()> stage_ns{};
};

struct Block {
  std::vector<Period> periods;
  std::uint64_t overruns = 0;     // periods that began a whole one late
  std::uint64_t fault_ticks = 0;  // in mode Fault, after too many of those in a row
  long page_faults = 0;
  long voluntary_switches = 0;
  long involuntary_switches = 0;
};

// `periods` of 1 ms of the servo's loop, in the calling thread. It holds a ball at its goal, by the pictures
// that `eye` takes, with an arm that obeys its model.
Block RunServoBlock(const config::ServoConfig& config, EyeChain& eye, int periods);

// `periods` of 1 ms of sleep to the next deadline and nothing else, by clock_nanosleep.
Block RunSleepBlock(int periods);

}  // namespace fovea::bench
