// SPDX-License-Identifier: Apache-2.0
// A camera that is not ideal: its lens distorts the picture, its sensor is off-centre or has pixels that are
// not square. Its pictures are resampled from a larger and finer picture of a plain pinhole camera.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/render/pinhole.hpp"

namespace fovea::sim {

// Brown's lens: radial k1, k2, k3, tangential p1, p2. (Brown, Close-range camera calibration, 1971.)
struct Lens {
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;

  [[nodiscard]] bool IsZero() const { return k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0 && k3 == 0.0; }
};

// Image of the ideal point `xy` through the lens. Both are in the normalised image.
Eigen::Vector2d Distort(const Lens& lens, const Eigen::Vector2d& xy);

// Inverse of Distort: the ideal point whose image is `xy`. False if there is none, or if the lens folds the
// picture between the centre and `xy`.
[[nodiscard]] bool Undistort(const Lens& lens, const Eigen::Vector2d& xy, Eigen::Vector2d& ideal);

// Whether the picture of a plain pinhole must be resampled.
inline bool NeedsLensMap(const Lens& lens, const Pinhole& pinhole) {
  return !lens.IsZero() || !pinhole.IsPlain();
}

class LensMap {
 public:
  // std::invalid_argument: the lens folds the picture, or sees a wider field than the renderer can draw.
  LensMap(const Lens& lens, const Pinhole& pinhole);

  // The pinhole to render for Apply.
  [[nodiscard]] const Pinhole& wide() const { return wide_; }
  // Resamples a picture of `wide` [pixels * 4] to the sensor [pixels * 4]: four points per pixel, averaged.
  void Apply(std::span<const std::uint8_t> from, std::span<std::uint8_t> to) const;
  // The same for rows of the sensor only: from `begin` to the one before `end`.
  void ApplyRows(int begin, int end, std::span<const std::uint8_t> from, std::span<std::uint8_t> to) const;
  // The rows of the wide picture that ApplyRows needs: from the first to the one before the second.
  [[nodiscard]] std::pair<int, int> WideRows(int begin, int end) const;

 private:
  // The four pixels of the wide picture around a point, and their weights.
  struct Place {
    std::int32_t top_left = 0;  // index of the first pixel
    std::uint8_t right = 0;     // weights [1/256]
    std::uint8_t down = 0;
  };
  static constexpr int kPoints = 4;  // per pixel

  // Of the first point in row `row` of the sensor.
  [[nodiscard]] std::size_t PlaceOfRow(int row) const {
    return static_cast<std::size_t>(row) * width_ * kPoints;
  }

  std::size_t width_;  // of the sensor [px]
  Pinhole wide_;
  std::vector<Place> places_;  // kPoints for each pixel
};

}  // namespace fovea::sim
