// SPDX-License-Identifier: Apache-2.0
// Measures how long the camera has shown the same picture. A camera that hangs repeats its last picture with
// new stamps, possibly with new noise.
//
// Compares patches of pixels, spread over the picture, with those of the first picture of a series of equal
// pictures. Pictures of an unchanged scene differ by noise, which is independent from pixel to pixel. With
// d_j the differences of a patch's n pixels,
//
//   R = sum over patches of (sum d_j)^2  /  sum over patches of sum d_j^2
//
// is 1 for pure noise of any level. If the scene changed, R is up to n, because whole patches become brighter
// or darker. A moved texture as fine as the pixels does not change R, but its differences exceed the smallest
// seen so far. A picture counts as the same if R and the size of the differences both match noise.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fovea::vision {

// For one thread. Allocates when a picture is larger than those before.
class PictureWatch {
 public:
  // Takes the next picture, CV_8UC3 or CV_8UC1, stamped `stamp_ns`. Returns how long the picture has been the
  // same [ns]; 0 when it differs from the series before it.
  std::int64_t Look(const cv::Mat& image, std::int64_t stamp_ns);

 private:
  void TakePatches(const cv::Mat& image, std::vector<std::uint8_t>& patches) const;
  [[nodiscard]] bool IsSame(const std::vector<std::uint8_t>& patches);

  std::vector<std::uint8_t> first_;  // patches of the first picture of the series
  std::vector<std::uint8_t> now_;
  std::int64_t first_stamp_ns_ = 0;
  double least_ = -1.0;  // smallest mean square difference above 0 so far; negative: none yet
};

}  // namespace fovea::vision
