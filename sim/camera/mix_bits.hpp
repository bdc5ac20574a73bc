// SPDX-License-Identifier: Apache-2.0
// Hashes a number to a pseudorandom number: the finaliser of SplitMix64 (Steele, Lea and Flood, Fast
// splittable pseudorandom number generators, 2014).
#pragma once

#include <cstdint>

namespace fovea::sim {

constexpr std::uint64_t MixBits(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

}  // namespace fovea::sim
