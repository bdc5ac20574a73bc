// SPDX-License-Identifier: Apache-2.0
// Conversion of pixel formats, with pictures of a known colour.
#include "fovea/camera/raw_picture.hpp"

#include <gtest/gtest.h>

#include <climits>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fovea/camera/frame_counter.hpp"

namespace fovea::camera {
namespace {

constexpr int kWidth = 8;
constexpr int kHeight = 6;
const cv::Vec3b kColour(200, 120, 30);  // blue, green, red

std::vector<std::uint8_t> Bytes(std::size_t bytes_per_pixel, int padding = 0) {
  return std::vector<std::uint8_t>(static_cast<std::size_t>(kHeight) *
                                   (kWidth * bytes_per_pixel + static_cast<std::size_t>(padding)));
}

cv::Vec3b Middle(const cv::Mat& picture) { return picture.at<cv::Vec3b>(kHeight / 2, kWidth / 2); }

// First and second row of each Bayer pattern, as in its GenICam name.
TEST(RawPicture, BayerPatternsMatchTheirNames) {
  for (const auto& [name, pattern] :
       {std::pair{"BayerRG8", "RGGB"}, {"BayerGR8", "GRBG"}, {"BayerGB8", "GBRG"}, {"BayerBG8", "BGGR"}}) {
    std::vector<std::uint8_t> bytes = Bytes(1);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const char channel = pattern[2 * (v % 2) + u % 2];
        bytes[static_cast<std::size_t>(v * kWidth + u)] = kColour[channel == 'B'   ? 0
                                                                  : channel == 'G' ? 1
                                                                                   : 2];
      }
    }
    const auto format = FormatOf(name);
    ASSERT_TRUE(format) << name;
    EXPECT_STREQ(Name(*format), name);
    cv::Mat out;
    ASSERT_TRUE(Unpack({*format, kWidth, kHeight, kWidth, bytes}, out)) << name;
    EXPECT_EQ(Middle(out), kColour) << name;
  }
}

TEST(RawPicture, RgbAndBgrKeepTheirChannelOrder) {
  for (const char* name : {"RGB8", "BGR8"}) {
    std::vector<std::uint8_t> bytes = Bytes(3);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const int channel = static_cast<int>(i % 3);
      bytes[i] = kColour[name[0] == 'B' ? channel : 2 - channel];
    }
    cv::Mat out;
    ASSERT_TRUE(Unpack({*FormatOf(name), kWidth, kHeight, 3 * kWidth, bytes}, out));
    EXPECT_EQ(Middle(out), kColour) << name;
  }
}

// Luma and chroma by the formula of ITU-R BT.601.
TEST(RawPicture, YuyvIsConvertedByBt601) {
  const double b = kColour[0] / 255.0;
  const double g = kColour[1] / 255.0;
  const double r = kColour[2] / 255.0;
  const auto Y = static_cast<std::uint8_t>(16.5 + 65.481 * r + 128.553 * g + 24.966 * b);
  const auto U = static_cast<std::uint8_t>(128.5 - 37.797 * r - 74.203 * g + 112.0 * b);
  const auto V = static_cast<std::uint8_t>(128.5 + 112.0 * r - 93.786 * g - 18.214 * b);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < kWidth * kHeight / 2; ++i) {
    bytes.insert(bytes.end(), {Y, U, Y, V});
  }
  cv::Mat out;
  ASSERT_TRUE(Unpack({RawFormat::kYuyv, kWidth, kHeight, 2 * kWidth, bytes}, out));
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(Middle(out)[channel], kColour[channel], 2) << channel;
  }
}

TEST(RawPicture, PaddedRowsAreUnpacked) {
  constexpr int kStride = kWidth + 5;
  std::vector<std::uint8_t> bytes = Bytes(1, 5);
  for (int v = 0; v < kHeight; ++v) {
    bytes[static_cast<std::size_t>(v * kStride + 3)] = static_cast<std::uint8_t>(10 + v);
  }
  cv::Mat out;
  ASSERT_TRUE(Unpack({RawFormat::kMono8, kWidth, kHeight, kStride, bytes}, out));
  for (int v = 0; v < kHeight; ++v) {
    EXPECT_EQ(out.at<std::uint8_t>(v, 3), 10 + v);
  }
  const hal::Frame frame = FrameOf(out);
  EXPECT_EQ(frame.format, hal::PixelFormat::kMono8);
  EXPECT_EQ(frame.width_px, kWidth);
}

TEST(RawPicture, ImpossibleGeometryIsRefused) {
  const std::vector<std::uint8_t> bytes = Bytes(1);
  cv::Mat out;
  EXPECT_FALSE(Unpack({RawFormat::kMono8, kWidth, kHeight + 1, kWidth, bytes}, out)) << "too few bytes";
  EXPECT_FALSE(Unpack({RawFormat::kMono8, kWidth, kHeight, kWidth - 1, bytes}, out)) << "rows overlap";
  EXPECT_FALSE(Unpack({RawFormat::kMono8, 0, kHeight, kWidth, bytes}, out));
  EXPECT_FALSE(Unpack({RawFormat::kMono8, kWidth, -1, kWidth, bytes}, out));
  EXPECT_FALSE(Unpack({RawFormat::kYuyv, 3, 2, 6, bytes}, out)) << "half a pixel pair";
  EXPECT_FALSE(Unpack({RawFormat::kBayerRg8, 1, 8, 1, bytes}, out));
  EXPECT_TRUE(out.empty());
  EXPECT_FALSE(FormatOf("Mono12"));
}

TEST(FrameCounter, CountsAcrossA16BitWrap) {
  FrameCounter counter(1, 65535);
  EXPECT_EQ(counter.Count(65534), 0U);
  EXPECT_EQ(counter.Count(65535), 1U);
  EXPECT_EQ(counter.Count(1), 2U);
  EXPECT_EQ(counter.Count(4), 5U);
  EXPECT_EQ(counter.lost(), 2U);
  EXPECT_EQ(counter.Count(3), 6U) << "a smaller number means that the device restarted";
  counter.Restart();
  EXPECT_EQ(counter.Count(40000), 7U);
  EXPECT_EQ(counter.lost(), 2U);
}

TEST(FrameCounter, CountsAcrossA64BitWrap) {
  FrameCounter counter;
  EXPECT_EQ(counter.Count(UINT64_MAX), 0U);
  EXPECT_EQ(counter.Count(1), 2U);
  EXPECT_EQ(counter.lost(), 1U);
  EXPECT_EQ(counter.Count(1), 3U);
}

TEST(FrameCounter, ImplausibleNumberCountsAsTheNextFrame) {
  FrameCounter counter;
  EXPECT_EQ(counter.Count(0), 0U);
  EXPECT_EQ(counter.Count(std::uint64_t{1} << 32U), std::uint64_t{1} << 32U)
      << "a gap of 2^32 frames is allowed";
  EXPECT_EQ(counter.Count((std::uint64_t{1} << 33U) + 1), (std::uint64_t{1} << 32U) + 1)
      << "a larger gap is not";
  EXPECT_EQ(counter.Count(std::uint64_t{1} << 62U), (std::uint64_t{1} << 32U) + 2);
}

TEST(RawPicture, PaddingSetsOnlyPossibleStrides) {
  RawPicture raw{RawFormat::kBgr8, 4, 2, 0, {}};
  ASSERT_TRUE(SetPadding(5, raw));
  EXPECT_EQ(raw.stride_bytes, 17);
  EXPECT_FALSE(SetPadding(-1, raw));
  EXPECT_FALSE(SetPadding(INT_MAX, raw)) << "the row length overflows an int";
  raw.width_px = INT_MAX / 2;
  EXPECT_FALSE(SetPadding(0, raw));
  raw.width_px = -4;
  EXPECT_FALSE(SetPadding(0, raw));
  EXPECT_EQ(raw.stride_bytes, 17);
}

}  // namespace
}  // namespace fovea::camera
