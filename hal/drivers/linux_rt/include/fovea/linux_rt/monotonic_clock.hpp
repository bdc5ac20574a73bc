// CLOCK_MONOTONIC with absolute deadlines.
#pragma once

#include "fovea/hal/clock.hpp"

namespace fovea::linux_rt {

class MonotonicClock final : public hal::Clock {
 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override;
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;
};

}  // namespace fovea::linux_rt
