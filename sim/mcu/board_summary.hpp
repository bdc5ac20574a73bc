// Figures of a run whose servo was on a board.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "firmware/core/link/messages.hpp"

namespace fovea::sim {

// Instructions of one tick each.
struct InstructionSpread {
  std::uint32_t min = 0;
  std::uint32_t p50 = 0;
  std::uint32_t max = 0;
};

struct BoardTicks {
  std::string mode;  // "" : of all modes
  std::uint64_t ticks = 0;
  InstructionSpread tick;
  std::vector<std::pair<std::string, InstructionSpread>> stages;  // in their order
};

struct BoardSummary {
  bool by_timer = false;
  int instruction_ns = 0;               // of the board's time, each
  double instructions_per_count = 0.0;  // of the timer that they are read from: what they are rounded by
  BoardTicks all;
  std::vector<BoardTicks> modes;           // those that there were, in their order
  InstructionSpread link;                  // a tick's frame taken in, and the one before it sent
  std::uint32_t stack_bytes = 0;           // the deepest
  link::LineCounters line;                 // what the board counted
  std::uint64_t frames_sent_again = 0;     // by the host, which heard no answer
  std::string stopped;                     // why the host closed the brakes, "" when it did not
  std::uint64_t ticks_without_torque = 0;  // by the timer: no new one had come, the last was held
};

}  // namespace fovea::sim
