// SPDX-License-Identifier: Apache-2.0
// A pseudorandom number per event, computed from the seed and the event's number alone. It does not depend on
// the order of the calls, so a run repeats exactly.
#pragma once

#include <cstdint>

#include "sim/camera/mix_bits.hpp"

namespace fovea::sim {

// Returns a number in [0, 1).
constexpr double Chance(std::uint64_t seed, std::uint64_t event) {
  constexpr double kPerUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return static_cast<double>(MixBits(seed + MixBits(event + 0x9E3779B97F4A7C15U)) >> 11U) * kPerUnit;
}

}  // namespace fovea::sim
