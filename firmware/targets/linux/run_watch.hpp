// What a run says and notes as its records come by: changes of mode, and faults.
#pragma once

#include <string>
#include <utility>

#include "firmware/targets/linux/hw_summary.hpp"
#include "firmware/targets/linux/speaker.hpp"

namespace fovea::hw {

class RunWatch {
 public:
  // Both are borrowed.
  RunWatch(HwSummary& summary, Speaker& speaker) : summary_(summary), speaker_(speaker) {}

  // `finishes`: the run is at its end, and the arm is brought to rest, which is no mode that it ended in.
  void Add(const hal::TickRecord& record, bool finishes);
  // An event, said and kept for the summary.
  void Say(const std::string& line);

  // Whether the arm's states come anew; true once after each AwaitArm.
  bool ArmIsBack() { return std::exchange(back_, false); }
  void AwaitArm() { awaited_ = true; }

 private:
  [[nodiscard]] double Seconds(const hal::TickRecord& record) const;

  HwSummary& summary_;
  Speaker& speaker_;
  std::uint64_t sequence_ = 0;  // of the arm's newest state
  bool awaited_ = false;
  bool back_ = false;
};

}  // namespace fovea::hw
