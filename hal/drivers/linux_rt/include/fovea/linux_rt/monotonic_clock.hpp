// SPDX-License-Identifier: Apache-2.0
// CLOCK_MONOTONIC with absolute deadlines.
#pragma once

#include <cstdint>

#include "fovea/hal/clock.hpp"

namespace fovea::linux_rt {

std::int64_t MonotonicNs() noexcept;
void SleepUntilNs(std::int64_t time_ns) noexcept;  // on the clock of MonotonicNs(); at once if past

class MonotonicClock final : public hal::Clock {
 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override;
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;
};

}  // namespace fovea::linux_rt
