// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/run_watch.hpp"

#include <fmt/format.h>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/run/in_words.hpp"

namespace fovea::hw {

void RunWatch::Add(const hal::TickRecord& record, bool finishes) {
  if (!summary_.start_ns) {
    summary_.start_ns = record.stamp_ns;
  }
  if (awaited_ && record.arm.sequence != sequence_) {
    awaited_ = false;
    back_ = true;
  }
  silent_ticks_ = record.arm.sequence == sequence_ ? silent_ticks_ + 1 : 0;
  summary_.robot_silent = silent_ticks_ >= task::ServoLoop::kMostSilentTicks;
  sequence_ = record.arm.sequence;
  if (record.has_feature) {
    summary_.feature_ages.Add(record.stamp_ns - record.feature.stamp_ns);
    ++summary_.measurements[hal::Name(record.intake)];
  }
  if (summary_.modes.empty() || record.mode != summary_.modes.back().mode ||
      record.hold_reason != summary_.modes.back().reason) {
    summary_.modes.push_back({Seconds(record), record.mode, record.hold_reason});
  }
  const bool faulty = record.fault != hal::Fault::kNone;
  if (finishes && !summary_.finish_t_s) {
    summary_.finish_t_s = Seconds(record);
  }
  if (finishes && !faulty) {
    return;
  }
  summary_.hold_reason = record.hold_reason;
  if (record.mode == summary_.mode && record.fault == summary_.fault) {
    return;
  }
  summary_.mode = record.mode;
  summary_.fault = record.fault;
  const char* mode = hal::Name(record.mode);
  if (!faulty) {
    Say(mode);
  } else {
    Say(fmt::format("{}: {}", mode, hal::Name(record.fault)),
        fmt::format("{}: {}", mode, run::InWords(record.fault)));
    summary_.faults.push_back({Seconds(record), record.fault, record.fault_joint});
  }
}

void RunWatch::Say(const std::string& event, const std::string& words) {
  summary_.events.push_back(event);
  speaker_.Say(words);
}

double RunWatch::Seconds(const hal::TickRecord& record) const {
  return 1e-9 * static_cast<double>(record.stamp_ns - summary_.start_ns.value_or(record.stamp_ns));
}

}  // namespace fovea::hw
