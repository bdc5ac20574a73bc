// SPDX-License-Identifier: Apache-2.0
// Likeness of a colour to the target's: a weight of hue and saturation, as a table over BGR.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/vision/detector_config.hpp"

namespace fovea::vision {

class ColourModel {
 public:
  explicit ColourModel(const ColourConfig& config);

  // 0 to 255.
  [[nodiscard]] std::uint8_t Likeness(unsigned blue, unsigned green, unsigned red) const {
    return table_[((blue >> kDrop) << (2 * kBits)) | ((green >> kDrop) << kBits) | (red >> kDrop)];
  }
  // 0 to 1, without the table's quantisation; slower.
  [[nodiscard]] double Exactly(double blue, double green, double red) const;

 private:
  static constexpr unsigned kBits = 6;  // per channel in the table
  static constexpr unsigned kDrop = 8 - kBits;
  ColourConfig config_;
  std::vector<std::uint8_t> table_;
};

}  // namespace fovea::vision
