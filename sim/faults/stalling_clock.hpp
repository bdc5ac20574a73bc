// SPDX-License-Identifier: Apache-2.0
// A clock whose waits end too late, so that the servo misses ticks.
#pragma once

#include <limits>

#include "fovea/hal/clock.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct StallFault {
  TimeWindow window;
  double share = 1.0;  // share of missed ticks in the window
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<StallFault> Fault>
void Fields(Visitor& v, Fault& f) {
  v.Window({"deadline_miss", "s", "the servo's computer misses ticks"}, f.window,
           "the client times the ticks");
  v.Number({"deadline_miss", "", "share of missed ticks, at random"}, f.share, 0.0, 1.0);
}

class StallingClock final : public hal::Clock {
 public:
  // `clock` is borrowed.
  StallingClock(hal::Clock& clock, const StallFault& fault) : clock_(clock), fault_(fault) {}

  // Changes the fault from the next tick on, except its seed. From the thread that waits, also within a wait
  // of the clock below.
  void SetFault(const StallFault& fault) {
    fault_.window = fault.window;
    fault_.share = fault.share;
  }
  // From `end_ns` on no tick is missed: a run ends there, whatever the fault's window. From the same thread.
  void EndAt(std::int64_t end_ns) { end_ns_ = end_ns; }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs(); }
  // A wait for a missed tick ends at the next tick that is not missed. Waits for each of them in turn: what
  // happens between ticks goes on.
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  hal::Clock& clock_;
  StallFault fault_;
  std::int64_t end_ns_ = std::numeric_limits<std::int64_t>::max();
};

}  // namespace fovea::sim
