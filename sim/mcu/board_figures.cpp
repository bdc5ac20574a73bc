// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/board_figures.hpp"

#include <algorithm>
#include <cmath>

#include "fovea/hal/events.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kManyTicks = 100'000;  // reserved, so that the loop does not allocate

InstructionSpread SpreadOf(std::vector<std::uint32_t> counts, double instructions_per_count) {
  if (counts.empty()) {
    return {};
  }
  std::sort(counts.begin(), counts.end());
  const auto instructions = [&](std::uint32_t count) {
    return static_cast<std::uint32_t>(std::lround(count * instructions_per_count));
  };
  return {instructions(counts.front()), instructions(counts[counts.size() / 2]), instructions(counts.back())};
}

}  // namespace

BoardFigures::BoardFigures() { ticks_.reserve(kManyTicks); }

void BoardFigures::Add(const link::Outputs& outputs) {
  ticks_.push_back({outputs.record.mode, outputs.tick_counts, outputs.link_counts, outputs.stage_counts});
  stack_bytes_ = std::max(stack_bytes_, outputs.stack_bytes);
  line_ = outputs.line;
}

void BoardFigures::Fill(double instructions_per_count, BoardSummary& summary) const {
  summary.instructions_per_count = instructions_per_count;
  summary.stack_bytes = stack_bytes_;
  summary.line = line_;
  const auto spread = [&](const auto& is_meant, const auto& counts_of) {
    std::vector<std::uint32_t> counts;
    counts.reserve(ticks_.size());
    for (const Tick& tick : ticks_) {
      if (is_meant(tick)) {
        counts.push_back(counts_of(tick));
      }
    }
    return SpreadOf(std::move(counts), instructions_per_count);
  };
  const auto ticks_of = [&](const auto& is_meant) {
    BoardTicks ticks;
    ticks.ticks = static_cast<std::uint64_t>(std::count_if(ticks_.begin(), ticks_.end(), is_meant));
    ticks.tick = spread(is_meant, [](const Tick& tick) { return tick.counts; });
    for (std::size_t i = 0; i < link::kNumStages; ++i) {
      ticks.stages.emplace_back(task::kStageNames[i],
                                spread(is_meant, [i](const Tick& tick) { return tick.stage_counts[i]; }));
    }
    return ticks;
  };
  const auto any = [](const Tick& /*tick*/) { return true; };
  summary.all = ticks_of(any);
  summary.link = spread(any, [](const Tick& tick) { return tick.link_counts; });
  for (int m = 0; m < hal::kNumModes; ++m) {
    const auto mode = static_cast<hal::Mode>(m);
    BoardTicks ticks = ticks_of([mode](const Tick& tick) { return tick.mode == mode; });
    if (ticks.ticks > 0) {
      ticks.mode = hal::Name(mode);
      summary.modes.push_back(std::move(ticks));
    }
  }
}

}  // namespace fovea::sim
