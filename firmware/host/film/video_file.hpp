// SPDX-License-Identifier: Apache-2.0
// An H.264 film in an MP4 file, as browsers play it (yuv420p), written frame by frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

namespace fovea::film {

// One thread uses it. The same frames give the same bytes.
class VideoFile {
 public:
  // Width and height must be even. std::runtime_error of one line when file or encoder cannot be opened.
  VideoFile(const std::filesystem::path& path, int width_px, int height_px);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  // Shows `bgr` (CV_8UC3) from `stamp_ns` on. A stamp less than 11 us (the film's resolution) after the last
  // one moves to 11 us after it.
  void Add(const cv::Mat& bgr, std::int64_t stamp_ns);
  // Writes the frames that are still buffered and the file's index. Without it the file cannot be played.
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::film
