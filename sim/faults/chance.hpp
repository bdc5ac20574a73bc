// SPDX-License-Identifier: Apache-2.0
// A pseudorandom number per event, computed from the seed and the event's number alone. It does not depend on
// the order of the calls, so a run repeats exactly.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "sim/camera/mix_bits.hpp"

namespace fovea::sim {

// Returns a number in [0, 1).
constexpr double Chance(std::uint64_t seed, std::uint64_t event) {
  constexpr double kPerUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return static_cast<double>(MixBits(seed + MixBits(event + 0x9E3779B97F4A7C15U)) >> 11U) * kPerUnit;
}

// Returns a normal number about 0 of standard deviation 1, from the events `first_event` and the one after.
// Box and Muller, A note on the generation of random normal deviates (1958).
inline double NormalChance(std::uint64_t seed, std::uint64_t first_event) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Chance(seed, first_event)));
  return radius * std::cos(2.0 * std::numbers::pi * Chance(seed, first_event + 1));
}

}  // namespace fovea::sim
