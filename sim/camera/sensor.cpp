// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>

#include "sim/camera/mix_bits.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kLongestRow = 3 * 4096;

// The colour of each pixel in a 2 x 2 block, row by row: blue (0), green (1) or red (2).
std::array<std::size_t, 4> ColoursOf(camera::RawFormat mosaic) {
  switch (mosaic) {
    case camera::RawFormat::kBayerRg8: return {2, 1, 1, 0};
    case camera::RawFormat::kBayerGr8: return {1, 2, 0, 1};
    case camera::RawFormat::kBayerGb8: return {1, 0, 2, 1};
    default: return {0, 1, 1, 2};
  }
}

// cos^4 of a pixel's angle to the optical axis. The lens' distortion is ignored.
float ShareOfLight(const Pinhole& pinhole, std::size_t column, std::size_t row) {
  const double x = (static_cast<double>(column) - pinhole.c_u_px) / pinhole.f_px;
  const double y = (static_cast<double>(row) - pinhole.c_v_px) / pinhole.FocalV();
  const double by_cos2 = 1.0 + x * x + y * y;
  return static_cast<float>(1.0 / (by_cos2 * by_cos2));
}

}  // namespace

Sensor::Sensor(const SensorConfig& config, std::uint64_t seed) : config_(config), seed_(seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, std::max(config.read_sigma, 1e-9));
  noise_.resize(kTableSize + kLongestRow);
  for (std::int8_t& n : noise_) {
    n = static_cast<std::int8_t>(std::clamp(std::lround(normal(engine)), -127L, 127L));
  }
  normal_.resize(kTableSize + kLongestRow);
  std::normal_distribution<float> unit(0.0F, 1.0F);
  for (float& n : normal_) {
    n = unit(engine);
  }
}

std::size_t Sensor::StartOf(std::uint64_t stream, std::uint64_t frame, std::size_t row) const {
  return MixBits(seed_ + stream + MixBits(frame * 8192U + row)) % kTableSize;
}

void Sensor::Expose(std::span<const std::uint8_t> rgba, int width_px, std::uint64_t frame,
                    std::span<std::uint8_t> bgr, double gain) const {
  const auto width = static_cast<std::size_t>(width_px);
  const std::size_t rows = bgr.size() / (3 * width);
  const bool is_plain = config_.IsPlain() && gain == 1.0;
  for (std::size_t row = 0; row < rows; ++row) {
    const std::uint8_t* in = rgba.data() + row * width * 4;
    std::uint8_t* out = bgr.data() + row * width * 3;
    // Simple passes over the row, so that the compiler vectorises them.
    for (std::size_t x = 0; x < width; ++x) {
      out[3 * x + 0] = in[4 * x + 2];
      out[3 * x + 1] = in[4 * x + 1];
      out[3 * x + 2] = in[4 * x + 0];
    }
    if (is_plain) {
      AddReadNoise(row, frame, {out, 3 * width});
    } else {
      ConvertRow(row, frame, config_.gain * gain, {out, 3 * width});
    }
  }
  if (config_.mosaic) {
    Interpolate(width_px, bgr);
  }
}

void Sensor::AddReadNoise(std::size_t row, std::uint64_t frame, std::span<std::uint8_t> bgr) const {
  const std::int8_t* noise = noise_.data() + StartOf(0, frame, row);
  for (std::size_t i = 0; i < bgr.size(); ++i) {
    const int value = bgr[i] + noise[i];
    bgr[i] = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
}

void Sensor::ConvertRow(std::size_t row, std::uint64_t frame, double gain,
                        std::span<std::uint8_t> bgr) const {
  const float* shot = normal_.data() + StartOf(1, frame, row);
  const float* read = normal_.data() + StartOf(2, frame, row);
  const auto a = static_cast<float>(config_.shot_noise);
  const auto b = static_cast<float>(config_.read_sigma);
  const auto most = static_cast<float>(config_.saturation);
  const auto g = static_cast<float>(gain);
  for (std::size_t i = 0; i < bgr.size(); ++i) {
    float x = bgr[i];
    if (config_.vignetting) {
      x *= ShareOfLight(*config_.vignetting, i / 3, row);
    }
    x = std::min(x + std::sqrt(a * x) * shot[i], most);
    bgr[i] = static_cast<std::uint8_t>(std::clamp(g * (x + b * read[i]) + 0.5F, 0.0F, 255.0F));
  }
}

void Sensor::Interpolate(int width_px, std::span<std::uint8_t> bgr) const {
  const std::array<std::size_t, 4> colours = ColoursOf(*config_.mosaic);
  const auto width = static_cast<std::size_t>(width_px);
  std::vector<std::uint8_t> bytes(bgr.size() / 3);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = bgr[3 * i + colours[2 * (i / width % 2) + i % width % 2]];
  }
  const camera::RawPicture raw{*config_.mosaic, width_px, static_cast<int>(bytes.size() / width), width_px,
                               bytes};
  cv::Mat picture(raw.height_px, width_px, CV_8UC3, bgr.data());  // Unpack writes into a picture that fits
  if (!camera::Unpack(raw, picture)) {
    throw std::invalid_argument("a picture of one row or column has no Bayer mosaic");
  }
}

double MeanOf(std::span<const std::uint8_t> bgr) {
  const std::uint64_t sum = std::accumulate(bgr.begin(), bgr.end(), std::uint64_t{0});
  return static_cast<double>(sum) / static_cast<double>(bgr.size());
}

}  // namespace fovea::sim
