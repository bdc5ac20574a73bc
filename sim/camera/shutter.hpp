// SPDX-License-Identifier: Apache-2.0
// How long a sensor is exposed, and when each of its rows is.
//
// Row v is exposed for `exposure_ns` about t + (v - (height - 1) / 2) row_time, where t is the stamp: the
// middle of the exposure of the picture's middle. A picture is the mean of `sub_exposures` sharp pictures at
// evenly spread times of the exposure. For a uniform motion by d pixels in the exposure the outline's place
// is exact for any number n, and its width too small by the factor sqrt(1 - 1 / n^2).
#pragma once

#include <cmath>
#include <cstdint>

namespace fovea::sim {

struct Shutter {
  std::int64_t exposure_ns = 5'000'000;
  int sub_exposures = 1;     // 1: the picture is sharp, taken at one time of the exposure
  double row_time_ns = 0.0;  // from one row to the next; 0: all rows at once

  [[nodiscard]] bool IsSharp() const { return sub_exposures == 1 && row_time_ns == 0.0; }
  // Time of sub-exposure `k` of a row, after the row's middle.
  [[nodiscard]] double SubExposureNs(int k) const {
    return ((k + 0.5) / sub_exposures - 0.5) * static_cast<double>(exposure_ns);
  }
  // Time of the upper edge of row `row`, after the stamp. Rows have their middle at whole numbers.
  [[nodiscard]] double EdgeNs(double row, int height_px) const {
    return (row - 0.5 * height_px) * row_time_ns;
  }
  // From the stamp to the end of the last row's exposure; as long before it the first row's begins. 0: the
  // picture is taken at one instant.
  [[nodiscard]] std::int64_t ReachNs(int height_px) const {
    return IsSharp() ? 0
                     : (exposure_ns + 1) / 2 +
                           static_cast<std::int64_t>(std::ceil(0.5 * (height_px - 1) * row_time_ns));
  }
};

}  // namespace fovea::sim
