// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/camera/mix_bits.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kLongestRow = 3 * 4096;

}  // namespace

Sensor::Sensor(double noise_sigma, std::uint64_t seed) : noise_(kTableSize + kLongestRow), seed_(seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, std::max(noise_sigma, 1e-9));
  for (std::int8_t& n : noise_) {
    n = static_cast<std::int8_t>(std::clamp(std::lround(normal(engine)), -127L, 127L));
  }
}

void Sensor::Expose(std::span<const std::uint8_t> rgba, int width_px, std::uint64_t frame,
                    std::span<std::uint8_t> bgr) const {
  const auto width = static_cast<std::size_t>(width_px);
  const std::size_t rows = bgr.size() / (3 * width);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t start = MixBits(seed_ + MixBits(frame * 8192U + row)) % kTableSize;
    const std::int8_t* noise = noise_.data() + start;
    const std::uint8_t* in = rgba.data() + row * width * 4;
    std::uint8_t* out = bgr.data() + row * width * 3;
    // Two simple passes over the row, so that the compiler vectorises the second one.
    for (std::size_t x = 0; x < width; ++x) {
      out[3 * x + 0] = in[4 * x + 2];
      out[3 * x + 1] = in[4 * x + 1];
      out[3 * x + 2] = in[4 * x + 0];
    }
    for (std::size_t i = 0; i < 3 * width; ++i) {
      const int value = out[i] + noise[i];
      out[i] = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
    }
  }
}

}  // namespace fovea::sim
