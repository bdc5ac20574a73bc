// For how long the camera has shown the same picture: one that hangs repeats it, with fresh stamps, and even
// with fresh noise.
//
// Patches of pixels spread over the picture are compared with those of the first picture of a row. What two
// pictures of one scene differ by is noise, and noise of one pixel knows nothing of the next: with d_j the
// differences of a patch's n pixels,
//
//   R = sum over patches of (sum d_j)^2  /  sum over patches of sum d_j^2
//
// is 1 for noise alone, whatever its size, and up to n where the scene changed, since then whole patches get
// brighter or darker. A texture as fine as the pixels moves R by nothing, but the differences themselves grow
// beyond the smallest that were seen. Both must be as for noise for a picture to count as the same.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fovea::vision {

// One thread uses it. Allocates at the first picture of a size.
class PictureWatch {
 public:
  // Looks at the next picture, CV_8UC3 or CV_8UC1, stamped `stamp_ns`. Returns for how long it has been the
  // same [ns]; 0 when it is another than the one before.
  std::int64_t Look(const cv::Mat& image, std::int64_t stamp_ns);

 private:
  void TakePatches(const cv::Mat& image, std::vector<std::uint8_t>& patches) const;
  [[nodiscard]] bool IsSame(const std::vector<std::uint8_t>& patches);

  std::vector<std::uint8_t> first_;  // patches of the first picture of the row
  std::vector<std::uint8_t> now_;
  std::int64_t first_stamp_ns_ = 0;
  double least_ = -1.0;  // the smallest mean square difference between two pictures; below 0: none yet
};

}  // namespace fovea::vision
