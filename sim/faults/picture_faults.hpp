// SPDX-License-Identifier: Apache-2.0
// Faults of a picture: a glare that saturates a spot of it, an object in front of the lens that hides a part
// of it, mirroring.
#pragma once

#include <cstdint>
#include <span>

#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct PictureFaults {
  struct {
    TimeWindow window;
    double u_px = 320.0;
    double v_px = 240.0;
    double radius_px = 60.0;  // white inside; fades to nothing at 1.5 times this radius
  } glare;
  struct {
    TimeWindow window;
    double u_px = 320.0;  // of its middle
    double v_px = 240.0;
    double width_px = 60.0;
    double height_px = 480.0;
  } occluder;         // dark, with sharp edges
  TimeWindow mirror;  // left and right are swapped
};

template <class Visitor, Struct<PictureFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  v.Window({"mirror", "s", "the camera's pictures are mirrored, left is right"}, f.mirror);
  v.Window({"glare", "s", "a glare saturates a spot of the picture"}, f.glare.window);
  v.Numbers({"glare_px", "px", "u and v of its middle, its radius; it fades out over half as far again"},
            -4096.0, 8192.0, f.glare.u_px, f.glare.v_px, f.glare.radius_px);
  v.Size({"glare_px"}, f.glare.radius_px);
  v.Window({"occluder", "s", "something dark hides a part of the picture"}, f.occluder.window);
  v.Numbers({"occluder_px", "px", "u and v of its middle, its width and height"}, -4096.0, 8192.0,
            f.occluder.u_px, f.occluder.v_px, f.occluder.width_px, f.occluder.height_px);
  v.Size({"occluder_px"}, f.occluder.width_px);
  v.Size({"occluder_px"}, f.occluder.height_px);
}

// Adds the faults to a picture `rgba` [pixels * 4] of `width_px` pixels per row, exposed at `stamp_ns`. The
// glare comes after the occluder: light covers everything. Called by many threads.
void SpoilPicture(const PictureFaults& faults, std::int64_t stamp_ns, int width_px,
                  std::span<std::uint8_t> rgba);

}  // namespace fovea::sim
