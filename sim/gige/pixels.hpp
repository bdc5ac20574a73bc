// SPDX-License-Identifier: Apache-2.0
// Converts a rendered picture to a pixel format of GigE Vision.
#pragma once

#include <cstdint>
#include <span>

#include "fovea/hal/camera.hpp"

namespace fovea::sim {

// Writes the top left `width_px` x `height_px` pixels of `frame` (BGR8) to `out`, in GigE Vision's format
// number `pixel_format`: Mono8, RGB8, BGR8, or one of the four 8-bit Bayer patterns. All black for any other
// format, or if `frame` or `out` is too small.
void FillPixels(const hal::Frame& frame, int width_px, int height_px, std::uint32_t pixel_format,
                std::span<std::uint8_t> out);

}  // namespace fovea::sim
