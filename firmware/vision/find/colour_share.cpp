// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/colour_share.hpp"

#include <cmath>

namespace fovea::vision {

double ColourShare(const Picture& image, const ColourModel& colour, std::span<const ImagePoint> points) {
  if (image.channels() == 1) {
    return 1.0;
  }
  constexpr double kAlike = 0.3;  // likeness of a colour that counts as the target's
  int alike = 0;
  int count = 0;
  for (const ImagePoint& p : points) {
    const int x = static_cast<int>(std::lround(p.u_px));
    const int y = static_cast<int>(std::lround(p.v_px));
    if (x < 1 || y < 1 || x >= image.cols - 1 || y >= image.rows - 1) {
      continue;
    }
    image.Need({x - 1, y - 1, 3, 3});
    // The mean of a 3 x 3 patch, so that noise in a dark image does not change the hue.
    cv::Vec3i sum(0, 0, 0);
    for (int dy = -1; dy <= 1; ++dy) {
      const cv::Vec3b* row = image.ptr<cv::Vec3b>(y + dy);
      for (int dx = -1; dx <= 1; ++dx) {
        sum += cv::Vec3i(row[x + dx]);
      }
    }
    alike += colour.Exactly(sum[0] / 9.0, sum[1] / 9.0, sum[2] / 9.0) > kAlike ? 1 : 0;
    ++count;
  }
  return count > 0 ? static_cast<double>(alike) / count : 0.0;
}

}  // namespace fovea::vision
