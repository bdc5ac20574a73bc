// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/notice_book.hpp"

namespace fovea::sim {

NoticeBook::NoticeBook(const std::vector<FaultWindow>& faults) {
  faults_.reserve(faults.size());
  for (const FaultWindow& fault : faults) {
    faults_.push_back({fault.name, fault.from_s, fault.to_s, {}});
  }
}

void NoticeBook::Add(const hal::TickRecord& record) {
  missed_ticks_ += record.missed_ticks;
  const auto ticks = static_cast<std::int64_t>(record.tick) + missed_ticks_;
  now_s_ = 1e-9 * static_cast<double>(ticks * hal::kTickPeriodNs);
  const bool new_state = record.command.state_sequence != state_before_;
  state_before_ = record.command.state_sequence;
  if (faults_.empty()) {
    return;
  }
  if (record.fault != hal::Fault::kNone) {
    Note(std::string("fault_") + hal::Name(record.fault));
  }
  Note(std::string("mode_") + hal::Name(record.mode));
  for (int i = 0; i < hal::kNumLimits; ++i) {
    const auto limit = static_cast<hal::Limit>(i);
    if ((record.limits_active & hal::Bit(limit)) != 0) {
      Note(std::string("limit_") + hal::Name(limit));
    }
  }
  if (!new_state) {
    Note("state_missing");
  }
  if (record.missed_ticks > 0) {
    Note("missed_ticks");
  }
  if (record.intake == hal::Intake::kNotFound) {
    Note("target_not_found");
  } else if (record.intake != hal::Intake::kNone && record.intake != hal::Intake::kTaken) {
    Note("measurement_left_out");
  }
  if (record.way.event == hal::PlanEvent::kLate) {
    Note("plan_late");
  }
}

void NoticeBook::Note(const std::string& what) {
  constexpr double kHalfTickS = 0.5e-9 * static_cast<double>(hal::kTickPeriodNs);
  for (InjectedFault& fault : faults_) {
    if (now_s_ >= fault.from_s - kHalfTickS) {
      fault.noticed.emplace(what, now_s_);
    }
  }
}

}  // namespace fovea::sim
