// Pictures as they come from devices, and as the seam wants them: mono8 or BGR8.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

#include "fovea/hal/camera.hpp"

namespace fovea::camera {

enum class RawFormat : std::uint8_t {
  kMono8,
  kBayerRg8,  // the first row is red, green, red, ...; one byte per pixel
  kBayerGr8,
  kBayerGb8,
  kBayerBg8,
  kYuyv,  // YUV 4:2:2, two bytes per pixel: Y0 U Y1 V
  kRgb8,
  kBgr8,
};

// "Mono8", "BayerRG8", ..., "YUYV", "RGB8", "BGR8"; empty when the seam knows no such format.
std::optional<RawFormat> FormatOf(const std::string& name);
const char* Name(RawFormat format);
int RawBytesPerPixel(RawFormat format);
// What the picture is behind the seam.
hal::PixelFormat UnpackedFormat(RawFormat format);

struct RawPicture {
  RawFormat format = RawFormat::kMono8;
  int width_px = 0;
  int height_px = 0;
  int stride_bytes = 0;  // from one row to the next
  std::span<const std::uint8_t> bytes;
};

// Sets `raw`'s stride to that of rows with `padding` bytes after their pixels. False, with `raw` as it was:
// no such rows are possible.
bool SetPadding(int padding, RawPicture& raw);

// Into `out`, whose memory is used again when it fits. False, with `out` as it was: fewer bytes than the
// picture needs, no size, a Bayer picture under 2 x 2 or a YUYV one of odd width.
bool Unpack(const RawPicture& raw, cv::Mat& out);

// A picture that `Unpack` made as a frame of the seam, without its times; a view of `picture`.
hal::Frame FrameOf(const cv::Mat& picture);

}  // namespace fovea::camera
