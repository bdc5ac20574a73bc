// SPDX-License-Identifier: Apache-2.0
// The image sensor: from the light on it to the gray levels of its picture.
//
// A rendered value is linear in light: gray levels at gain 1. In this order, for each pixel and colour:
//
//   vignetting   x = cos^4(angle to the optical axis) r
//   photons      x gets noise of variance shot_noise x, and at most `saturation` is collected
//   read-out     plus noise of deviation read_sigma, times the gain, rounded, 0 to 255
//   mosaic       with a Bayer pattern each pixel has one colour; the others are interpolated as the drivers
//   do
//
// So the variance of a gray level y is a y + b with a = gain shot_noise and b = (gain read_sigma)^2 (EMVA
// Standard 1288, release 3.1, section 2).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fovea/camera/raw_picture.hpp"
#include "sim/render/pinhole.hpp"

namespace fovea::sim {

struct SensorConfig {
  double read_sigma = 0.0;                    // [gray levels] at gain 1
  double shot_noise = 0.0;                    // variance per gray level [gray levels] at gain 1
  double gain = 1.0;                          // AutoExposure's comes on top
  double saturation = 255.0;                  // [gray levels] at gain 1
  std::optional<Pinhole> vignetting{};        // of the camera whose pixels get less light away from its axis
  std::optional<camera::RawFormat> mosaic{};  // one of the Bayer patterns; none: each pixel has all colours

  // True if the sensor adds read noise and does nothing else.
  [[nodiscard]] bool IsPlain() const {
    return shot_noise == 0.0 && gain == 1.0 && saturation == 255.0 && !vignetting && !mosaic;
  }
};

// Equal seed and frame number give equal noise. Long tables hold the noise; each row of each frame reads them
// from other starts. Several threads may use it.
class Sensor {
 public:
  Sensor(const SensorConfig& config, std::uint64_t seed);

  // Converts `rgba` [pixels * 4] to `bgr` [pixels * 3]. `width_px` pixels per row. `gain`: of the automatic
  // exposure. std::invalid_argument: a mosaic of one row or column.
  void Expose(std::span<const std::uint8_t> rgba, int width_px, std::uint64_t frame,
              std::span<std::uint8_t> bgr, double gain = 1.0) const;

 private:
  static constexpr std::size_t kTableSize = std::size_t{1} << 20U;

  void AddReadNoise(std::size_t row, std::uint64_t frame, std::span<std::uint8_t> bgr) const;
  void ConvertRow(std::size_t row, std::uint64_t frame, double gain, std::span<std::uint8_t> bgr) const;
  [[nodiscard]] std::size_t StartOf(std::uint64_t stream, std::uint64_t frame, std::size_t row) const;
  void Interpolate(int width_px, std::span<std::uint8_t> bgr) const;

  const SensorConfig config_;
  const std::uint64_t seed_;
  std::vector<std::int8_t> noise_;  // read noise in whole gray levels; of a plain sensor
  std::vector<float> normal_;       // of standard deviation 1; of all others
};

// Mean gray level of a picture that a sensor has made.
double MeanOf(std::span<const std::uint8_t> bgr);

}  // namespace fovea::sim
