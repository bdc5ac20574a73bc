// SPDX-License-Identifier: Apache-2.0
#include "fovea/camera/raw_picture.hpp"

#include <array>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace fovea::camera {
namespace {

struct Known {
  const char* name;
  int bytes_per_pixel;
  int conversion;  // OpenCV's, to BGR; -1: a copy
};

// In the order of RawFormat. OpenCV's two-letter Bayer names start at the second row's second pixel; its
// four-letter names mean the same as GenICam's.
constexpr std::array<Known, 8> kFormats{{{"Mono8", 1, -1},
                                         {"BayerRG8", 1, cv::COLOR_BayerRGGB2BGR},
                                         {"BayerGR8", 1, cv::COLOR_BayerGRBG2BGR},
                                         {"BayerGB8", 1, cv::COLOR_BayerGBRG2BGR},
                                         {"BayerBG8", 1, cv::COLOR_BayerBGGR2BGR},
                                         {"YUYV", 2, cv::COLOR_YUV2BGR_YUYV},
                                         {"RGB8", 3, cv::COLOR_RGB2BGR},
                                         {"BGR8", 3, -1}}};

const Known& Of(RawFormat format) { return kFormats[static_cast<std::size_t>(format)]; }

bool IsBayer(RawFormat format) { return format >= RawFormat::kBayerRg8 && format <= RawFormat::kBayerBg8; }

bool IsPossible(const RawPicture& raw) {
  if (raw.width_px <= 0 || raw.height_px <= 0 ||
      (IsBayer(raw.format) && (raw.width_px < 2 || raw.height_px < 2)) ||
      (raw.format == RawFormat::kYuyv && raw.width_px % 2 != 0)) {
    return false;
  }
  const std::int64_t row = std::int64_t{raw.width_px} * Of(raw.format).bytes_per_pixel;
  const std::int64_t needed = std::int64_t{raw.stride_bytes} * (raw.height_px - 1) + row;
  return raw.stride_bytes >= row && static_cast<std::int64_t>(raw.bytes.size()) >= needed;
}

}  // namespace

std::optional<RawFormat> FormatOf(const std::string& name) {
  for (std::size_t i = 0; i < kFormats.size(); ++i) {
    if (name == kFormats[i].name) {
      return static_cast<RawFormat>(i);
    }
  }
  return std::nullopt;
}

const char* Name(RawFormat format) { return Of(format).name; }
int RawBytesPerPixel(RawFormat format) { return Of(format).bytes_per_pixel; }

hal::PixelFormat UnpackedFormat(RawFormat format) {
  return format == RawFormat::kMono8 ? hal::PixelFormat::kMono8 : hal::PixelFormat::kBgr8;
}

bool SetPadding(int padding, RawPicture& raw) {
  const std::int64_t stride = std::int64_t{raw.width_px} * Of(raw.format).bytes_per_pixel + padding;
  if (raw.width_px <= 0 || padding < 0 || stride > std::numeric_limits<int>::max()) {
    return false;
  }
  raw.stride_bytes = static_cast<int>(stride);
  return true;
}

bool Unpack(const RawPicture& raw, cv::Mat& out) {
  if (!IsPossible(raw)) {
    return false;
  }
  const Known& known = Of(raw.format);
  // A view; OpenCV's type has no const.
  const cv::Mat in(raw.height_px, raw.width_px, CV_8UC(known.bytes_per_pixel),
                   const_cast<std::uint8_t*>(raw.bytes.data()), static_cast<std::size_t>(raw.stride_bytes));
  if (known.conversion < 0) {
    in.copyTo(out);
  } else {
    cv::cvtColor(in, out, known.conversion);
  }
  return true;
}

hal::Frame FrameOf(const cv::Mat& picture) {
  hal::Frame frame;
  frame.width_px = picture.cols;
  frame.height_px = picture.rows;
  frame.stride_bytes = static_cast<std::int32_t>(picture.step[0]);
  frame.format = picture.channels() == 1 ? hal::PixelFormat::kMono8 : hal::PixelFormat::kBgr8;
  frame.pixels = {picture.data, picture.step[0] * static_cast<std::size_t>(picture.rows)};
  frame.maker = nullptr;
  return frame;
}

}  // namespace fovea::camera
