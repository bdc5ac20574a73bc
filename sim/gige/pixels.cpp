// SPDX-License-Identifier: Apache-2.0
#include "sim/gige/pixels.hpp"

#include <arv.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace fovea::sim {
namespace {

// The colour of each pixel in a 2 x 2 block, row by row: blue (0), green (1) or red (2).
using Mosaic = std::array<std::size_t, 4>;

Mosaic MosaicOf(std::uint32_t pixel_format) {
  switch (pixel_format) {
    case ARV_PIXEL_FORMAT_BAYER_RG_8: return {2, 1, 1, 0};
    case ARV_PIXEL_FORMAT_BAYER_GR_8: return {1, 2, 0, 1};
    case ARV_PIXEL_FORMAT_BAYER_GB_8: return {1, 0, 2, 1};
    default: return {0, 1, 1, 2};
  }
}

bool IsBayer(std::uint32_t pixel_format) {
  return pixel_format == ARV_PIXEL_FORMAT_BAYER_RG_8 || pixel_format == ARV_PIXEL_FORMAT_BAYER_GR_8 ||
         pixel_format == ARV_PIXEL_FORMAT_BAYER_GB_8 || pixel_format == ARV_PIXEL_FORMAT_BAYER_BG_8;
}

// Luma by ITU-R BT.601; weights in 1/256.
std::uint8_t Luma(const std::uint8_t* bgr) {
  return static_cast<std::uint8_t>((29U * bgr[0] + 150U * bgr[1] + 77U * bgr[2] + 128U) >> 8U);
}

}  // namespace

void FillPixels(const hal::Frame& frame, int width_px, int height_px, std::uint32_t pixel_format,
                std::span<std::uint8_t> out) {
  const bool is_colour =
      pixel_format == ARV_PIXEL_FORMAT_RGB_8_PACKED || pixel_format == ARV_PIXEL_FORMAT_BGR_8_PACKED;
  const bool is_known = is_colour || pixel_format == ARV_PIXEL_FORMAT_MONO_8 || IsBayer(pixel_format);
  const std::size_t depth = is_colour ? 3 : 1;
  const auto width = static_cast<std::size_t>(std::max(width_px, 0));
  const auto height = static_cast<std::size_t>(std::max(height_px, 0));
  if (!is_known || out.size() < depth * width * height || frame.width_px < width_px ||
      frame.height_px < height_px) {
    std::fill(out.begin(), out.end(), std::uint8_t{0});
    return;
  }
  const Mosaic mosaic = MosaicOf(pixel_format);
  for (std::size_t v = 0; v < height; ++v) {
    const std::uint8_t* bgr = frame.pixels.data() + v * static_cast<std::size_t>(frame.stride_bytes);
    std::uint8_t* to = out.data() + v * depth * width;
    for (std::size_t u = 0; u < width; ++u, bgr += 3) {
      if (pixel_format == ARV_PIXEL_FORMAT_MONO_8) {
        to[u] = Luma(bgr);
      } else if (is_colour) {
        const bool swap = pixel_format == ARV_PIXEL_FORMAT_RGB_8_PACKED;
        to[3 * u] = bgr[swap ? 2 : 0];
        to[3 * u + 1] = bgr[1];
        to[3 * u + 2] = bgr[swap ? 0 : 2];
      } else {
        to[u] = bgr[mosaic[2 * (v % 2) + u % 2]];
      }
    }
  }
}

}  // namespace fovea::sim
