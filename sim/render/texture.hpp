// SPDX-License-Identifier: Apache-2.0
// Computed textures of the bench: equal on every machine, without third-party pictures.
#pragma once

#include <cstdint>
#include <vector>

namespace fovea::sim {

struct Texture {
  int width_px = 0;  // both are powers of two: software renderers read those faster
  int height_px = 0;
  std::vector<std::uint8_t> rgba;  // [height * width * 4]
};

// The whole table top: light birch, with a dark mat in the arm's working area, ruled every 10 mm and 50 mm.
// `width_m` and `depth_m` are the table's size; the mat's centre and size are in the table's own frame.
Texture MakeTableTop(int size_px, double width_m, double depth_m, double mat_x, double mat_y,
                     double mat_width, double mat_depth);

// A floor of large grey tiles. The texture repeats.
Texture MakeFloor(int size_px);

}  // namespace fovea::sim
