// SPDX-License-Identifier: Apache-2.0
// Prints and stores the changes of mode and the faults in a run's records.
#pragma once

#include <string>
#include <utility>

#include "firmware/targets/linux/hw_summary.hpp"
#include "fovea/linux_rt/speaker.hpp"

namespace fovea::hw {

class RunWatch {
 public:
  // Both are borrowed.
  RunWatch(HwSummary& summary, linux_rt::Speaker& speaker) : summary_(summary), speaker_(speaker) {}

  // `finishes`: the arm is brought to rest at the end; modes from then on do not count as the final mode.
  void Add(const hal::TickRecord& record, bool finishes);
  // Prints an event and keeps it for the summary.
  void Say(const std::string& line) { Say(line, line); }

  // Whether new states of the arm arrive; true once after each AwaitArm.
  bool ArmIsBack() { return std::exchange(back_, false); }
  void AwaitArm() { awaited_ = true; }

 private:
  // Prints `words` for the event that the summary keeps.
  void Say(const std::string& event, const std::string& words);
  [[nodiscard]] double Seconds(const hal::TickRecord& record) const;

  HwSummary& summary_;
  linux_rt::Speaker& speaker_;
  std::uint64_t sequence_ = 0;  // of the arm's newest state
  int silent_ticks_ = 0;        // in a row, without a new state
  bool awaited_ = false;
  bool back_ = false;
};

}  // namespace fovea::hw
