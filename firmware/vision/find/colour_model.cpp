// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/colour_model.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::vision {

ColourModel::ColourModel(const ColourConfig& config)
    : config_(config), table_(std::size_t{1} << (3 * kBits)) {
  constexpr unsigned kLevels = 1U << kBits;
  const auto level = [](unsigned index) { return (index + 0.5) * (1U << kDrop) - 0.5; };
  for (unsigned b = 0; b < kLevels; ++b) {
    for (unsigned g = 0; g < kLevels; ++g) {
      for (unsigned r = 0; r < kLevels; ++r) {
        table_[(b << (2 * kBits)) | (g << kBits) | r] =
            static_cast<std::uint8_t>(std::lround(255.0 * Exactly(level(b), level(g), level(r))));
      }
    }
  }
}

double ColourModel::Exactly(double blue, double green, double red) const {
  const double high = std::max({blue, green, red});
  const double chroma = high - std::min({blue, green, red});
  if (!(high > 0.0) || !(chroma > 0.0)) {
    return 0.0;
  }
  double hue_deg = 60.0 * (red - green) / chroma + 240.0;
  if (high == red) {
    hue_deg = 60.0 * (green - blue) / chroma;
  } else if (high == green) {
    hue_deg = 60.0 * (blue - red) / chroma + 120.0;
  }
  const double off = std::remainder(hue_deg - config_.hue_deg, 360.0) / config_.hue_width_deg;
  // The weight rises from 0 at saturation_min to 1 at saturation_min + 0.2.
  const double coloured = std::clamp((chroma / high - config_.saturation_min) / 0.2, 0.0, 1.0);
  return std::exp(-0.5 * off * off) * coloured;
}

}  // namespace fovea::vision
