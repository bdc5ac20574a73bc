// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same on all machines; those of the standard's distributions are not.
#pragma once

#include <random>

namespace fovea::atlas {

// A number in [low, high).
[[nodiscard]] inline double Uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11U) * 0x1p-53;
}

}  // namespace fovea::atlas
