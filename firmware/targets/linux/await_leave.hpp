// What stands between a robot that holds by itself and a servo that moves it.
#pragma once

#include <optional>
#include <string>

#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/operator_thread.hpp"
#include "fovea/linux_rt/bounded_ring.hpp"

namespace fovea::hw {

// What came of a wish to move.
struct LeaveFinding {
  bool passed = false;
  const char* trouble = nullptr;  // why gravity could not be compared; static storage
  GravityFinding gravity;         // where it could
};
[[nodiscard]] std::string InWords(const LeaveFinding& finding, double allowed_nm);

// Looks at the states of an arm that holds by itself, until there is a finding.
class LeaveLook {
 public:
  LeaveLook(const HwConfig& config, const model::ArmModel& model)
      : config_(config), model_(model), mean_(MakeRestMean(config)) {}

  // The next read of the arm, and what it answered.
  [[nodiscard]] std::optional<LeaveFinding> Add(const hal::Status& status, const hal::ArmState& state);
  void BeginAnew();

 private:
  const HwConfig& config_;
  const model::ArmModel& model_;
  RestMean mean_;
  int failed_reads_ = 0;  // in a row
};

using LeaveRing = linux_rt::BoundedRing<LeaveFinding>;

// Reads states until motion is asked for and gravity is as the model has it: true. The findings go to
// `findings`. False when it was told to end, or, where motion was asked for from the start (`only_once`),
// after the first that did not pass. From the arm's thread.
bool AwaitLeave(const HwConfig& config, const model::ArmModel& model, bool only_once, hal::Arm& arm,
                hal::Clock& clock, RunControl& control, LeaveRing& findings);

}  // namespace fovea::hw
