// SPDX-License-Identifier: Apache-2.0
// Times each period of the servo's loop in real time, and of a loop that only sleeps, as cyclictest does.
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
  std::int32_t off_period_ns = 0;  // |time since the last wake-up - 1 ms|; 0 for a block's first period
  std::int32_t execute_ns = 0;     // from the wake-up until the command was written; 0 for a sleeper
  std::int32_t response_ns = 0;    // from the deadline until the command was written
  // Time of each stage of the tick; the first includes reading the arm.
  std::array<std::int32_t, task::kStageNames.size()> stage_ns{};
};

struct Block {
  std::vector<Period> periods;
  std::uint64_t overruns = 0;     // periods that began at least one period late
  std::uint64_t fault_ticks = 0;  // ticks in mode Fault, after too many overruns in a row
  long page_faults = 0;
  long voluntary_switches = 0;
  long involuntary_switches = 0;
};

// Runs the servo's loop for `periods` of 1 ms in the calling thread. The servo keeps a ball at its goal, with
// the pictures that `eye` takes and an arm that obeys its model.
Block RunServoBlock(const config::ServoConfig& config, EyeChain& eye, int periods);

// Sleeps until the next deadline with clock_nanosleep, for `periods` of 1 ms, and does nothing else.
Block RunSleepBlock(int periods);

}  // namespace fovea::bench
