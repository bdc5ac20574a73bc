// SPDX-License-Identifier: Apache-2.0
// Figures of a run whose servo was on a board.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "firmware/core/link/messages.hpp"

namespace fovea::sim {

// Instructions per tick.
struct InstructionSpread {
  std::uint32_t min = 0;
  std::uint32_t p50 = 0;
  std::uint32_t max = 0;
};

struct BoardTicks {
  std::string mode;  // "": all modes
  std::uint64_t ticks = 0;
  InstructionSpread tick;
  std::vector<std::pair<std::string, InstructionSpread>> stages;  // in execution order
};

struct BoardSummary {
  bool by_timer = false;
  int instruction_ns = 0;               // the board's time per instruction
  double instructions_per_count = 0.0;  // of the board's timer: the resolution of the instruction figures
  BoardTicks all;
  std::vector<BoardTicks> modes;           // modes that occurred, in order of hal::Mode
  InstructionSpread link;                  // to receive a tick's frame and send the previous answer
  std::uint32_t stack_bytes = 0;           // deepest use of the stack
  link::LineCounters line;                 // counters of the board
  std::uint64_t frames_sent_again = 0;     // repeated by the host because no answer came
  std::string stopped;                     // why the host closed the brakes; "" if it did not
  std::uint64_t ticks_without_torque = 0;  // with the timer: no new torque came, the last one was held
};

}  // namespace fovea::sim
