// SPDX-License-Identifier: Apache-2.0
// The frame buffer that a picture is drawn into.
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <span>

#include "sim/render/gl_program.hpp"
#include "sim/render/pinhole.hpp"

namespace fovea::sim {

class Canvas {
 public:
  // `samples` per pixel; 0 or 1: one. std::runtime_error: the driver cannot draw into it.
  Canvas(int width_px, int height_px, int samples);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  // What is drawn next is drawn into it.
  void Bind() const;
  // From here to the next clearing of the depth, only `areas` are drawn into: everything else counts as
  // hidden. So the driver computes no colours there. Clear the depth before.
  void DrawOnly(std::span<const PictureArea> areas) const;
  // Averages the samples, if there are several per pixel.
  void Resolve() const;
  // Reads `rows` rows from `begin_px` on into `rgba` [height * width * 4], top row first. Call Resolve
  // before.
  void Read(int begin_px, int rows, std::span<std::uint8_t> rgba) const;

 private:
  const int width_px_;
  const int height_px_;
  const bool multisampled_;
  const GlProgram area_program_;
  GLuint area_array_ = 0;
  GLuint area_buffer_ = 0;
  GLuint frames_[2] = {0, 0};  // drawn into, resolved
  GLuint buffers_[3] = {0, 0, 0};
};

}  // namespace fovea::sim
