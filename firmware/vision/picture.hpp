// SPDX-License-Identifier: Apache-2.0
// A picture as the detectors read it. Its pixels may be made only where somebody looks (hal::PixelMaker), so
// whoever reads pixels says before which ones.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "fovea/hal/camera.hpp"

namespace fovea::vision {

class Picture {
 public:
  // `pixels`: CV_8UC3 (BGR) or CV_8UC1. `maker`: of its pixels, null if all are there; outlives the picture.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Picture(const cv::Mat& pixels, hal::PixelMaker* maker = nullptr)
      : cols(pixels.cols), rows(pixels.rows), step(pixels.step), pixels_(pixels), maker_(maker) {}

  const int cols;
  const int rows;
  const std::size_t step;  // bytes from one row to the next
  [[nodiscard]] int channels() const { return pixels_.channels(); }

  // A row, from its pixel 0 on. Only pixels that were needed may be read.
  template <class Pixel>
  [[nodiscard]] const Pixel* ptr(int y) const {
    return pixels_.ptr<Pixel>(y);
  }
  // `area`, inside the picture, for OpenCV, whose filters read pixels around it too.
  [[nodiscard]] cv::Mat Cut(const cv::Rect& area) const {
    Need(Whole());
    return pixels_(area);
  }

  // Makes the pixels of `area` readable; what is outside the picture does not count.
  void Need(const cv::Rect& area) const {
    if (maker_ != nullptr && (area & Whole()) != (area & there_)) {
      Make(area, {});
    }
  }
  // The same, and `blocks` beside it, all at once: faster than one after the other.
  void Need(const cv::Rect& area, std::span<const hal::PixelArea> blocks) const {
    if (maker_ != nullptr) {
      Make(area, blocks);
    }
  }

 private:
  [[nodiscard]] cv::Rect Whole() const { return {0, 0, cols, rows}; }

  void Make(const cv::Rect& area, std::span<const hal::PixelArea> blocks) const {
    const bool is_first = there_.empty();
    there_ |= area & Whole();
    if (!is_first) {  // who looks beside the area will look further: half its size on each side
      const cv::Size room = there_.size() / 2;
      there_ = cv::Rect(there_.tl() - cv::Point(room), there_.size() + room + room) & Whole();
    }
    std::vector<hal::PixelArea> areas(blocks.begin(), blocks.end());
    if (!there_.empty()) {
      areas.push_back({there_.x, there_.y, there_.width, there_.height});
    }
    maker_->Make(areas);
  }

  const cv::Mat pixels_;
  hal::PixelMaker* const maker_;
  mutable cv::Rect there_;  // readable, beside blocks
};

}  // namespace fovea::vision
