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
  // Width and height are even. std::runtime_error with one line when the file or the encoder cannot be had.
  VideoFile(const std::filesystem::path& path, int width_px, int height_px);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  // `bgr` (CV_8UC3) is shown from `stamp_ns` on; one whose stamp is not 11 us after the last one's, the
  // film's resolution, comes just so much after it.
  void Add(const cv::Mat& bgr, std::int64_t stamp_ns);
  // Writes what is still held back and the file's index. Without it the file cannot be played.
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::film
