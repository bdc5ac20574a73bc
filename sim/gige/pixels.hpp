// A rendered picture as a GigE Vision camera sends it.
#pragma once

#include <cstdint>
#include <span>

#include "fovea/hal/camera.hpp"

namespace fovea::sim {

// The top left `width_px` x `height_px` of `frame` (BGR8) in the format with GigE Vision's number
// `pixel_format`: Mono8, RGB8, BGR8, or one of the four 8-bit Bayer patterns; black where the frame has
// nothing, or for any other format.
void FillPixels(const hal::Frame& frame, int width_px, int height_px, std::uint32_t pixel_format,
                std::span<std::uint8_t> out);

}  // namespace fovea::sim
