// SPDX-License-Identifier: Apache-2.0
// Records what the servo noticed since a fault began: faults, modes, limits, missing measurements, states and
// plans.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fovea/hal/record.hpp"
#include "sim/scenario/fault_settings.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

// Names of the events:
//   fault_<name>          a fault is latched
//   mode_<name>           the servo is in this mode
//   limit_<name>          this limit acts
//   state_missing         a tick without a new, usable state of the arm
//   missed_ticks          deadlines were missed
//   target_not_found      the target was not found in a frame
//   measurement_left_out  a measurement was rejected
//   plan_late             no plan came in time: the visual law goes on alone
// Times count the run's ticks, because the arm's own stamps may be faulty. Only one thread may use it.
class NoticeBook {
 public:
  explicit NoticeBook(const std::vector<FaultWindow>& faults);

  // Call it in the order of the ticks.
  void Add(const hal::TickRecord& record);

  // The faults, each with the events since its beginning and their first times.
  [[nodiscard]] const std::vector<InjectedFault>& Faults() const { return faults_; }

 private:
  void Note(const std::string& what);

  std::vector<InjectedFault> faults_;
  std::int64_t missed_ticks_ = 0;  // so far
  double now_s_ = 0.0;
  std::uint64_t state_before_ = 0;  // sequence of the last used state
};

}  // namespace fovea::sim
