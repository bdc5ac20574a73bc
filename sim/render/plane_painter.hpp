// SPDX-License-Identifier: Apache-2.0
// Draws the bench's horizontal surfaces, which fill most of each picture, at low cost in a software renderer.
//
// Light and static shadows are painted into the textures once. For each picture, a surface is split into
// tiles. Only tiles that a moving shadow may touch use the shadow map.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/render/bench.hpp"
#include "sim/render/cover.hpp"
#include "sim/render/gl_program.hpp"
#include "sim/render/shadow_map.hpp"

namespace fovea::sim {

// The bounding box of a moving thing, and its pose.
struct MovingBounds {
  Eigen::Isometry3f X_BL = Eigen::Isometry3f::Identity();
  Box box_L;
};

// The pixels of a painted surface.
struct PaintedSurface {
  int size_px = 0;                                // of a side of the first level
  std::vector<std::vector<std::uint8_t>> levels;  // RGBA; each has half the side of the one before
};

class PlanePainter {
 public:
  // Paints the light into the textures of `planes`; `draw_static` draws all static things. Or takes the
  // surfaces that another painter of the same planes and things has `painted`, in the same order.
  // `shadow_head` is the GLSL preamble that sets the quality of the moving shadows.
  PlanePainter(const std::vector<TexturedPlane>& planes, const std::string& shadow_head,
               const ShadowMap::DrawAll& draw_static, std::span<const PaintedSurface> painted);
  ~PlanePainter();
  PlanePainter(const PlanePainter&) = delete;
  PlanePainter& operator=(const PlanePainter&) = delete;

  // Draws all planes into the bound frame. `moving`: the things whose shadows are in `shadow`, including the
  // target. The target also darkens the ground under it. Skips planes below `bottom` [m], which are hidden.
  void Draw(const Eigen::Matrix4f& clip_of_B, float gain, const ShadowMap& shadow, const Ball& target,
            const std::vector<MovingBounds>& moving, float bottom) const;

  // The surfaces as they are on the graphics device.
  [[nodiscard]] std::vector<PaintedSurface> Painted() const;

 private:
  struct Plane {
    TexturedPlane shape;  // without its pixels
    GLuint texture = 0;
    int columns = 1;
    int rows = 1;
  };
  [[nodiscard]] GLuint PaintLight(const TexturedPlane& plane, const ShadowMap& shadow) const;
  // Sorts the tiles of `plane` into lit tiles and tiles that a moving shadow may touch.
  void SortTiles(const Plane& plane, const Ball& target, const std::vector<MovingBounds>& moving) const;
  void DrawTiles(const std::vector<Eigen::Vector2f>& tiles) const;

  GlProgram lit_program_;
  GlProgram shaded_program_;
  GLuint vertex_array_ = 0;
  GLuint tile_buffer_ = 0;
  std::vector<Plane> planes_;
  mutable std::vector<Eigen::Vector2f> lit_tiles_;  // lower corners of the tiles; memory reused
  mutable std::vector<Eigen::Vector2f> shaded_tiles_;
  mutable std::vector<Eigen::AlignedBox2f> darkened_;  // areas that may be darkened
};

}  // namespace fovea::sim
