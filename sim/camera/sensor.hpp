// The image sensor: what the light leaves in the pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fovea::sim {

// Adds read noise of a given standard deviation to a rendered picture, the same for the same seed and frame.
//
// Noise is drawn once into a long table; each row of each frame reads the table from a place of its own.
class Sensor {
 public:
  Sensor(double noise_sigma, std::uint64_t seed);

  // From `rgba` [pixels * 4] to `bgr` [pixels * 3], `width_px` pixels per row.
  void Expose(std::span<const std::uint8_t> rgba, int width_px, std::uint64_t frame,
              std::span<std::uint8_t> bgr) const;

 private:
  static constexpr std::size_t kTableSize = std::size_t{1} << 20U;
  std::vector<std::int8_t> noise_;  // [kTableSize + the longest row]
  std::uint64_t seed_;
};

}  // namespace fovea::sim
