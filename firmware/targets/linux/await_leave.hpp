// SPDX-License-Identifier: Apache-2.0
// Decides when the servo may take over a robot that holds by itself.
#pragma once

#include <optional>
#include <string>

#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/operator_thread.hpp"
#include "fovea/linux_rt/bounded_ring.hpp"

namespace fovea::hw {

// The result of a request to move.
struct LeaveFinding {
  bool passed = false;
  const char* trouble = nullptr;  // why gravity could not be compared; static storage
  GravityFinding gravity;         // if it could be compared
};
[[nodiscard]] std::string InWords(const LeaveFinding& finding, double allowed_nm);

// Compares gravity in the states of an arm that holds by itself, until there is a finding.
class LeaveLook {
 public:
  LeaveLook(const HwConfig& config, const model::ArmModel& model)
      : config_(config), model_(model), mean_(MakeRestMean(config)) {}

  // Takes the result of the next read. Returns the finding when there is one.
  [[nodiscard]] std::optional<LeaveFinding> Add(const hal::Status& status, const hal::ArmState& state);
  void BeginAnew();

 private:
  const HwConfig& config_;
  const model::ArmModel& model_;
  RestMean mean_;
  int failed_reads_ = 0;  // in a row
};

using LeaveRing = linux_rt::BoundedRing<LeaveFinding>;

// Reads states until motion is requested and gravity matches the model, then returns true. Puts each finding
// into `findings`. Returns false when the run ends, or, with `only_once` (motion requested from the start),
// after the first finding that does not pass. From the arm's thread.
bool AwaitLeave(const HwConfig& config, const model::ArmModel& model, bool only_once, hal::Arm& arm,
                hal::Clock& clock, RunControl& control, LeaveRing& findings);

}  // namespace fovea::hw
