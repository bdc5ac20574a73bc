// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/await_leave.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fovea::hw {
namespace {

constexpr int kMostFailedReads = 1000;  // in a row

}  // namespace

std::optional<LeaveFinding> LeaveLook::Add(const hal::Status& status, const hal::ArmState& state) {
  LeaveFinding finding;
  if (!status.ok()) {
    finding.trouble = status.where();
    return ++failed_reads_ < kMostFailedReads ? std::nullopt : std::optional(finding);
  }
  failed_reads_ = 0;
  if (mean_.Add(state)) {
    finding.gravity = CompareGravity(model_, mean_.q(), mean_.tau_meas());
    finding.passed = std::fabs(finding.gravity.worst_nm) <= config_.check.gravity_torque;
    return finding;
  }
  finding.trouble = "the arm does not come to rest";
  return mean_.IsInVain() ? std::optional(finding) : std::nullopt;
}

void LeaveLook::BeginAnew() {
  mean_ = MakeRestMean(config_);
  failed_reads_ = 0;
}

std::string InWords(const LeaveFinding& finding, double allowed_nm) {
  if (finding.passed) {
    return fmt::format("gravity: {}", InWords(finding.gravity));
  }
  const std::string why = finding.trouble != nullptr
                              ? std::string(finding.trouble)
                              : fmt::format(
                                    "{}; at most {} Nm are allowed (check.gravity_torque); check that "
                                    "arm.load_* is the load at the flange",
                                    InWords(finding.gravity), allowed_nm);
  return fmt::format("motion is refused: {}", why);
}

bool AwaitLeave(const HwConfig& config, const model::ArmModel& model, bool only_once, hal::Arm& arm,
                hal::Clock& clock, RunControl& control, LeaveRing& findings) {
  LeaveLook look(config, model);
  hal::ArmState state;
  bool looks = only_once;
  while (!control.ended) {
    const hal::Status status = arm.Read(state);
    if (control.enable_asked.exchange(false) && !looks) {
      looks = true;
      look.BeginAnew();
    }
    if (!status.ok()) {
      static_cast<void>(clock.WaitUntil(clock.NowNs() + hal::kTickPeriodNs));
    }
    if (!looks) {
      continue;
    }
    if (const auto finding = look.Add(status, state)) {
      findings.Push(*finding);
      if (finding->passed || only_once) {
        return finding->passed;
      }
      looks = false;
    }
  }
  return false;
}

}  // namespace fovea::hw
