// A camera that is not ideal: its lens moves what a pinhole would see, its sensor is not centred or has
// pixels that are not square. Pictures are resampled from a larger and finer one of a plain pinhole, as such
// a sensor would collect them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
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

// Where the lens puts the ideal point `xy` of the normalised image.
Eigen::Vector2d Distort(const Lens& lens, const Eigen::Vector2d& xy);

// The ideal point that the lens puts at `xy`. False when none is, or the lens has folded the picture before
// it.
[[nodiscard]] bool Undistort(const Lens& lens, const Eigen::Vector2d& xy, Eigen::Vector2d& ideal);

// Whether the picture of a plain pinhole must be resampled.
inline bool NeedsLensMap(const Lens& lens, const Pinhole& pinhole) {
  return !lens.IsZero() || !pinhole.IsPlain();
}

class LensMap {
 public:
  // std::invalid_argument: the lens folds the picture, or brings in more than a renderer can draw.
  LensMap(const Lens& lens, const Pinhole& pinhole);

  // The pinhole to render for Apply.
  [[nodiscard]] const Pinhole& wide() const { return wide_; }
  // From a picture of `wide` [pixels * 4] to the sensor's [pixels * 4]: each pixel the mean over four points
  // in it.
  void Apply(std::span<const std::uint8_t> from, std::span<std::uint8_t> to) const;

 private:
  // Between which four pixels of the wide picture a point lies.
  struct Place {
    std::int32_t top_left = 0;  // the first one's number
    std::uint8_t right = 0;     // shares of 256
    std::uint8_t down = 0;
  };
  static constexpr int kPoints = 4;  // per pixel

  Pinhole wide_;
  std::vector<Place> places_;  // kPoints for each pixel
};

}  // namespace fovea::sim
