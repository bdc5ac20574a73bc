// SPDX-License-Identifier: Apache-2.0
// The image sensor.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fovea::sim {

// Adds Gaussian read noise to a rendered picture. Equal seed and frame number give equal noise. A long table
// holds the noise; each row of each frame reads it from another start.
class Sensor {
 public:
  Sensor(double noise_sigma, std::uint64_t seed);

  // Converts `rgba` [pixels * 4] to `bgr` [pixels * 3] and adds noise. `width_px` pixels per row.
  void Expose(std::span<const std::uint8_t> rgba, int width_px, std::uint64_t frame,
              std::span<std::uint8_t> bgr) const;

 private:
  static constexpr std::size_t kTableSize = std::size_t{1} << 20U;
  std::vector<std::int8_t> noise_;  // [kTableSize + the longest row]
  std::uint64_t seed_;
};

}  // namespace fovea::sim
