// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/desk/servo_desk.hpp"

#include <optional>
#include <utility>

namespace fovea::desk {

ServoDesk::ServoDesk(const config::ServoConfig& config, task::ServoLoop& loop, DeskReports reports)
    : loop_(loop), reports_(std::move(reports)), tuner_(config) {}

live::Answer ServoDesk::Take(const live::Hold& /*request*/) {
  loop_.Ask(task::Request::kHold);
  reports_.touch("hold", "hold the arm");
  return {};
}

live::Answer ServoDesk::Take(const live::Track& /*request*/) {
  loop_.Ask(task::Request::kTrack);
  reports_.touch("track", "track the target");
  return {};
}

live::Answer ServoDesk::Take(const live::Recover& /*request*/) {
  if (mode_ != hal::Mode::kFault) {
    return {"there is no fault to recover from", "{}"};
  }
  loop_.Ask(task::Request::kReset);
  reports_.touch("recover", "recover from the fault");
  return {};
}

live::Answer ServoDesk::Take(const live::SetParameter& request) {
  return tuner_.Ask(request.parameter, request.value, loop_);
}

void ServoDesk::Note(const hal::TickRecord& record) {
  mode_ = record.mode;
  hold_reason_ = record.hold_reason;
  fault_ = record.fault;
  if (const std::optional<std::size_t> parameter = tuner_.Note(record.tuning)) {
    reports_.parameter(*parameter, tuner_.parameters()[*parameter].value);
  }
}

void ServoDesk::Fill(live::State& state) const {
  state.mode = hal::Name(mode_);
  if (mode_ == hal::Mode::kHold) {
    state.hold_reason = hal::Name(hold_reason_);
    state.hold_reason_words = hal::Words(hold_reason_);
  }
  if (fault_ != hal::Fault::kNone) {
    state.fault = hal::Name(fault_);
    state.fault_words = hal::Words(fault_);
  }
  state.notice = tuner_.notice();
}

}  // namespace fovea::desk
