// SPDX-License-Identifier: Apache-2.0
// Converts pictures from the formats of devices into those of the seam: mono8 or BGR8.
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

// By name: "Mono8", "BayerRG8", ..., "YUYV", "RGB8", "BGR8"; empty for other names.
std::optional<RawFormat> FormatOf(const std::string& name);
const char* Name(RawFormat format);
int RawBytesPerPixel(RawFormat format);
// The seam's format of the converted picture.
hal::PixelFormat UnpackedFormat(RawFormat format);

struct RawPicture {
  RawFormat format = RawFormat::kMono8;
  int width_px = 0;
  int height_px = 0;
  int stride_bytes = 0;  // from one row to the next
  std::span<const std::uint8_t> bytes;
};

// Sets `raw`'s stride to that of rows with `padding` bytes after their pixels. False, with `raw` unchanged,
// if such rows are impossible.
bool SetPadding(int padding, RawPicture& raw);

// Converts `raw` into `out`, whose memory is reused if it fits. False, with `out` unchanged: too few bytes,
// no size, a Bayer picture under 2 x 2 or a YUYV one of odd width.
bool Unpack(const RawPicture& raw, cv::Mat& out);

// A frame of the seam, without its times, that views `picture` (made by `Unpack`).
hal::Frame FrameOf(const cv::Mat& picture);

}  // namespace fovea::camera
