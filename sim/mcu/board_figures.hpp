// SPDX-License-Identifier: Apache-2.0
// Collects the cost of each tick on a board.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/core/link/messages.hpp"
#include "sim/mcu/board_summary.hpp"

namespace fovea::sim {

class BoardFigures {
 public:
  BoardFigures();

  // Does not allocate for the first hundred thousand ticks.
  void Add(const link::Outputs& outputs);
  // Fills in the counts and instructions of all ticks so far. Keeps the other fields of `summary`.
  void Fill(double instructions_per_count, BoardSummary& summary) const;

 private:
  struct Tick {
    hal::Mode mode;
    std::uint32_t counts;
    std::uint32_t link_counts;
    std::array<std::uint32_t, link::kNumStages> stage_counts;
  };
  std::vector<Tick> ticks_;
  std::uint32_t stack_bytes_ = 0;
  link::LineCounters line_;
};

}  // namespace fovea::sim
