// What the servo noticed since a fault began: faults, modes, limits, measurements and states that it did
// without.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fovea/hal/record.hpp"
#include "sim/scenario/fault_settings.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

// By the names under which it is noted:
//   fault_<name>          a fault is latched
//   mode_<name>           the servo is in this mode
//   limit_<name>          this limit acts
//   state_missing         a tick without a new state of the arm that could be taken
//   missed_ticks          deadlines were missed
//   target_not_found      a frame was looked at and the target is not in it
//   measurement_left_out  a measurement was not taken in
// Times are the run's, counted in ticks: the arm's own stamps may be at fault. One thread uses it.
class NoticeBook {
 public:
  explicit NoticeBook(const std::vector<FaultWindow>& faults);

  // In order of the ticks.
  void Add(const hal::TickRecord& record);

  // The faults and what was noticed from the beginning of each on, when first.
  [[nodiscard]] const std::vector<InjectedFault>& Faults() const { return faults_; }

 private:
  void Note(const std::string& what);

  std::vector<InjectedFault> faults_;
  std::int64_t missed_ticks_ = 0;  // so far
  double now_s_ = 0.0;
  std::uint64_t state_before_ = 0;  // the sequence of the last state that was taken
};

}  // namespace fovea::sim
