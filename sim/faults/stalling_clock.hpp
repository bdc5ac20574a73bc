// A clock whose waits end too late: the computer swallows ticks.
#pragma once

#include "fovea/hal/clock.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct StallFault {
  TimeWindow window;
  double share = 1.0;  // of the ticks in it that are swallowed
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<StallFault> Fault>
void Fields(Visitor& v, Fault& f) {
  v.Window({"deadline_miss", "s", "the servo's computer swallows ticks"}, f.window,
           "the ticks are the client's");
  v.Number({"deadline_miss", "", "share of them, by chance"}, f.share, 0.0, 1.0);
}

class StallingClock final : public hal::Clock {
 public:
  // `clock` is borrowed.
  StallingClock(hal::Clock& clock, const StallFault& fault) : clock_(clock), fault_(fault) {}

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs(); }
  // The wait for a tick that is swallowed ends at the next one that is not.
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  hal::Clock& clock_;
  const StallFault fault_;
};

}  // namespace fovea::sim
