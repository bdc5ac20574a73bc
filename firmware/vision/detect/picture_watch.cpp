// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/detect/picture_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fovea::vision {
namespace {

constexpr int kSide = 4;      // of a patch [px]
constexpr int kSpacing = 16;  // from one patch to the next [px]
constexpr int kStagger =
    kSpacing / kSide;  // by which patches are staggered, so that no line runs between them
constexpr std::size_t kPixels = kSide * kSide;
constexpr double kSigmas = 6.0;         // R of pure noise exceeds 1 by fewer standard deviations than this
constexpr double kMoreThanNoise = 1.3;  // mean square differences larger by this factor are not noise

// Calls `visit` with the left and top pixel of each patch.
template <class Visit>
void ForPatches(int width_px, int height_px, const Visit& visit) {
  for (int i = 0; i < height_px / kSpacing; ++i) {
    for (int j = 0; j < width_px / kSpacing; ++j) {
      visit(kSpacing * j + kSide * (i % kStagger), kSpacing * i + kSide * (j % kStagger));
    }
  }
}

}  // namespace

std::span<const hal::PixelArea> PictureWatch::Patches(int width_px, int height_px) {
  if (width_px != width_px_ || height_px != height_px_) {
    width_px_ = width_px;
    height_px_ = height_px;
    patches_.clear();
    ForPatches(width_px, height_px, [this](int left, int top) {
      patches_.push_back({left, top, kSide, kSide});
    });
  }
  return patches_;
}

void PictureWatch::TakePatches(const Picture& image, std::vector<std::uint8_t>& patches) {
  const int channels = image.channels();
  const int channel = channels == 3 ? 1 : 0;  // green
  std::size_t k = 0;
  const int across = image.cols / kSpacing;
  const int down = image.rows / kSpacing;
  patches.resize(static_cast<std::size_t>(across * down) * kPixels);
  ForPatches(image.cols, image.rows, [&](int left, int top) {
    for (int y = top; y < top + kSide; ++y) {
      const std::uint8_t* row = image.ptr<std::uint8_t>(y) + left * channels + channel;
      for (int x = 0; x < kSide; ++x) {
        patches[k++] = row[x * channels];
      }
    }
  });
}

bool PictureWatch::IsSame(const std::vector<std::uint8_t>& patches) {
  if (patches.size() != first_.size()) {
    return false;
  }
  std::int64_t of_patches = 0;  // sum of (sum d)^2
  std::int64_t of_pixels = 0;   // sum of d^2
  for (std::size_t k = 0; k < patches.size(); k += kPixels) {
    int sum = 0;
    int squares = 0;
    for (std::size_t j = k; j < k + kPixels; ++j) {
      const int d = int{patches[j]} - int{first_[j]};
      sum += d;
      squares += d * d;
    }
    of_patches += std::int64_t{sum} * sum;
    of_pixels += squares;
  }
  if (of_pixels == 0) {
    return true;
  }
  const std::size_t num_patches = patches.size() / kPixels;
  const double mean_square = static_cast<double>(of_pixels) / static_cast<double>(patches.size());
  least_ = least_ < 0.0 ? mean_square : std::min(least_, mean_square);
  const double ratio = static_cast<double>(of_patches) / static_cast<double>(of_pixels);
  return ratio <= 1.0 + kSigmas * std::sqrt(2.0 / static_cast<double>(num_patches)) &&
         mean_square <= kMoreThanNoise * least_;
}

std::int64_t PictureWatch::Look(const Picture& image, std::int64_t stamp_ns) {
  if (image.cols < kSpacing || image.rows < kSpacing) {
    return 0;
  }
  TakePatches(image, now_);
  if (IsSame(now_)) {
    return std::max<std::int64_t>(stamp_ns - first_stamp_ns_, 0);
  }
  std::swap(first_, now_);
  first_stamp_ns_ = stamp_ns;
  return 0;
}

}  // namespace fovea::vision
