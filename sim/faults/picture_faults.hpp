// What goes wrong with a picture: a glare that saturates a spot of it, a thing before the lens that hides a
// part of it, a picture that is mirrored.
#pragma once

#include <cstdint>
#include <span>

#include "sim/faults/time_window.hpp"

namespace fovea::sim {

struct PictureFaults {
  struct {
    TimeWindow window;
    double u_px = 0.0;
    double v_px = 0.0;
    double radius_px = 0.0;  // white within, and half as far again it fades out
  } glare;
  struct {
    TimeWindow window;
    double u_px = 0.0;  // of its middle
    double v_px = 0.0;
    double width_px = 0.0;
    double height_px = 0.0;
  } occluder;         // dark, with sharp edges
  TimeWindow mirror;  // left and right are swapped
};

// Into a drawn picture `rgba` [pixels * 4] of `width_px` pixels per row, exposed at `stamp_ns`. The glare
// comes after the occluder: light goes over everything. Called by many threads.
void SpoilPicture(const PictureFaults& faults, std::int64_t stamp_ns, int width_px,
                  std::span<std::uint8_t> rgba);

}  // namespace fovea::sim
