// Draws the bench's level surfaces, which fill most of every picture, as cheaply as a software renderer can.
//
// Light and the shadows of all that stands still are painted into the textures once. Per picture a surface is
// split into tiles: only those that a moving thing's shadow may touch look the shadow map up.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "sim/render/bench.hpp"
#include "sim/render/cover.hpp"
#include "sim/render/gl_program.hpp"
#include "sim/render/shadow_map.hpp"

namespace fovea::sim {

// A box that holds a moving thing, and where it is.
struct MovingBounds {
  Eigen::Isometry3f X_BL = Eigen::Isometry3f::Identity();
  Box box_L;
};

class PlanePainter {
 public:
  // Paints the light into the textures of `planes`; `draw_static` draws what stands still. `shadow_head` is
  // the GLSL preamble that sets the quality of the moving shadows.
  PlanePainter(const std::vector<TexturedPlane>& planes, const std::string& shadow_head,
               const ShadowMap::DrawAll& draw_static);
  ~PlanePainter();
  PlanePainter(const PlanePainter&) = delete;
  PlanePainter& operator=(const PlanePainter&) = delete;

  // Draws all planes into the bound frame. `moving` are the things whose shadows are in `shadow`, the target
  // among them; the target also darkens what it stands on. Planes below `bottom` [m] are hidden.
  void Draw(const Eigen::Matrix4f& clip_of_B, float gain, const ShadowMap& shadow, const Ball& target,
            const std::vector<MovingBounds>& moving, float bottom) const;

 private:
  struct Plane {
    TexturedPlane shape;  // without its pixels
    GLuint texture = 0;
    int columns = 1;
    int rows = 1;
  };
  [[nodiscard]] GLuint PaintLight(const TexturedPlane& plane, const ShadowMap& shadow) const;
  // Sorts the tiles of `plane` into those in the light and those that a moving shadow may touch.
  void SortTiles(const Plane& plane, const Ball& target, const std::vector<MovingBounds>& moving) const;
  void DrawTiles(const std::vector<Eigen::Vector2f>& tiles) const;

  GlProgram lit_program_;
  GlProgram shaded_program_;
  GLuint vertex_array_ = 0;
  GLuint tile_buffer_ = 0;
  std::vector<Plane> planes_;
  mutable std::vector<Eigen::Vector2f> lit_tiles_;  // their lower corners, reused from picture to picture
  mutable std::vector<Eigen::Vector2f> shaded_tiles_;
  mutable std::vector<Eigen::AlignedBox2f> darkened_;  // where these lie
};

}  // namespace fovea::sim
