// Likeness of a colour to the target's: a weight of hue and saturation, as a table over BGR.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace fovea::vision {

struct ColourConfig {
  double hue_deg = 0.0;          // of the target; 0 is red, 120 green, 240 blue
  double hue_width_deg = 12.0;   // standard deviation of the hue
  double saturation_min = 0.35;  // a colour below it has likeness 0; 0 to 1
};

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
