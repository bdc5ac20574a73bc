// SPDX-License-Identifier: Apache-2.0
// Keys that change in motion: checks a request, and moves the key to its new value along a smooth step.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/config/tuning.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::task {

inline constexpr std::int32_t kRampTicks = 250;  // from the old value to the new one

struct TuningState {
  struct Ramp {
    bool asked = false;  // since Init
    double from = 0.0;
    double to = 0.0;
    std::int32_t ticks = 0;  // since the request, kRampTicks at most
  };
  std::array<Ramp, config::kMostTunable> ramps;  // by the keys' numbers
  bool active = false;                           // in this tick a request came, or a key moved
  hal::TuningNote note;                          // of this tick
};

// One tick: answers `request`, and writes the keys that move into `config`. A request replaces the earlier
// one for its key; the key then moves on from its present value. Needed only if there is a request or `state`
// is active. Real-time: yes.
void Tune(const config::Tuning& request, config::ServoConfig& config, TuningState& state) noexcept;

// Writes the keys that have changed since Init into `config`. Real-time: yes.
void ApplyTunings(const TuningState& state, config::ServoConfig& config) noexcept;

}  // namespace fovea::task
