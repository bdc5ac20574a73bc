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
#include <span>
#include <vector>

#include "firmware/vision/picture.hpp"

namespace fovea::vision {

// For one thread. Allocates when a picture is larger than those before.
class PictureWatch {
 public:
  // The pixels that it looks at in a picture of this size.
  [[nodiscard]] std::span<const hal::PixelArea> Patches(int width_px, int height_px);
  // Takes the next picture, CV_8UC3 or CV_8UC1, stamped `stamp_ns`. Returns how long the picture has been the
  // same [ns]; 0 when it differs from the series before it.
  std::int64_t Look(const Picture& image, std::int64_t stamp_ns);

 private:
  static void TakePatches(const Picture& image, std::vector<std::uint8_t>& patches);
  [[nodiscard]] bool IsSame(const std::vector<std::uint8_t>& patches);

  std::vector<hal::PixelArea> patches_;  // in a picture of this size:
  int width_px_ = 0;
  int height_px_ = 0;
  std::vector<std::uint8_t> first_;  // patches of the first picture of the series
  std::vector<std::uint8_t> now_;
  std::int64_t first_stamp_ns_ = 0;
  double least_ = -1.0;  // smallest mean square difference above 0 so far; negative: none yet
};

}  // namespace fovea::vision
