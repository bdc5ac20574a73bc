// SPDX-License-Identifier: Apache-2.0
#include "sim/render/plane_painter.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "sim/render/light.hpp"
#include "sim/render/shaders.hpp"

namespace fovea::sim {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector2f;
using Eigen::Vector3f;
using Eigen::Vector4f;
using Rectangle = Eigen::AlignedBox2f;

constexpr float kTileSize = 0.10F;   // [m]
constexpr float kLargePlane = 4.0F;  // a plane of this size or larger is one tile [m]
constexpr int kPaintedShadowMapPx = 2048;
constexpr float kDarkenedReach = 4.0F;  // a ball darkens its ground up to this distance, in radii
constexpr float kShadowMargin = 0.03F;  // width of the shadow's soft edge [m]

const char* const kHead = "#version 330 core\n";
const char* const kPaintHead = "#version 330 core\n#define SHADOW_TAPS 16\n#define SHADOW_SPREAD 6.0\n";

void SetTextureFilter() {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

GLuint UploadTexture(const Texture& from) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, from.width_px, from.height_px, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               from.rgba.empty() ? nullptr : from.rgba.data());
  SetTextureFilter();
  return texture;
}

// A texture with the pixels of another one, level by level.
GLuint UploadSurface(const PaintedSurface& from) {
  const GLuint texture = UploadTexture({from.size_px, from.size_px, {}});
  int side_px = from.size_px;
  for (std::size_t level = 0; level < from.levels.size(); ++level, side_px /= 2) {
    glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, side_px, side_px, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, from.levels[level].data());
  }
  return texture;
}

PaintedSurface ReadSurface(GLuint texture) {
  PaintedSurface surface;
  glBindTexture(GL_TEXTURE_2D, texture);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &surface.size_px);
  for (int side_px = surface.size_px; side_px > 0; side_px /= 2) {
    const auto level = static_cast<GLint>(surface.levels.size());
    surface.levels.emplace_back(static_cast<std::size_t>(side_px) * static_cast<std::size_t>(side_px) * 4);
    glGetTexImage(GL_TEXTURE_2D, level, GL_RGBA, GL_UNSIGNED_BYTE, surface.levels.back().data());
  }
  return surface;
}

Vector2f LowCorner(const TexturedPlane& plane) { return plane.centre_B.head<2>() - 0.5F * plane.size; }

// Offset and scale that map x, y of B to texture coordinates.
Vector4f TextureOfXy(const TexturedPlane& plane, const Vector2f& tile) {
  const Vector2f scale = tile.cwiseInverse();
  const Vector2f offset = -LowCorner(plane).cwiseProduct(scale);
  return {offset.x(), offset.y(), scale.x(), scale.y()};
}

void SetShadowOfXy(const GlProgram& program, const Matrix4f& map_of_B, float z) {
  program.Set("u_shadow_0", Vector3f(map_of_B.block<3, 1>(0, 2) * z + map_of_B.block<3, 1>(0, 3)));
  program.Set("u_shadow_x", Vector3f(map_of_B.block<3, 1>(0, 0)));
  program.Set("u_shadow_y", Vector3f(map_of_B.block<3, 1>(0, 1)));
}

// Rectangle around the shadow of a thing on the plane at `z`, including its soft edge.
Rectangle ShadowOn(float z, const MovingBounds& thing) {
  Rectangle shadow;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3f p_B = thing.X_BL * thing.box_L.corner(static_cast<Box::CornerType>(corner));
    shadow.extend((p_B - kSun_B * ((p_B.z() - z) / kSun_B.z())).head<2>());
  }
  return {shadow.min() - Vector2f::Constant(kShadowMargin), shadow.max() + Vector2f::Constant(kShadowMargin)};
}

}  // namespace

PlanePainter::PlanePainter(const std::vector<TexturedPlane>& planes, const std::string& shadow_head,
                           const ShadowMap::DrawAll& draw_static, std::span<const PaintedSurface> painted)
    : lit_program_(std::string(kHead) + shaders::kPlaneVertex,
                   std::string(kHead) + shaders::kLitPlaneFragment),
      shaded_program_(shadow_head + shaders::kPlaneVertex,
                      shadow_head + shaders::kShadow + shaders::kShadedPlaneFragment) {
  glGenVertexArrays(1, &vertex_array_);
  glGenBuffers(1, &tile_buffer_);
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, tile_buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vector2f), nullptr);
  glVertexAttribDivisor(0, 1);

  std::optional<ShadowMap> shadow;
  if (painted.empty()) {
    shadow.emplace(kPaintedShadowMapPx);
    shadow->DrawStatic(draw_static);
    shadow->DrawMoving([](const ShadowMap::DrawAt&) {});
  }
  for (const TexturedPlane& shape : planes) {
    Plane plane;
    plane.shape = shape;
    plane.shape.texture.rgba.clear();
    plane.texture = shadow ? PaintLight(shape, *shadow) : UploadSurface(painted[planes_.size()]);
    if (shape.size.maxCoeff() < kLargePlane) {
      plane.columns = static_cast<int>(std::ceil(shape.size.x() / kTileSize));
      plane.rows = static_cast<int>(std::ceil(shape.size.y() / kTileSize));
    }
    planes_.push_back(std::move(plane));
  }
}

PlanePainter::~PlanePainter() {
  for (const Plane& plane : planes_) {
    glDeleteTextures(1, &plane.texture);
  }
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteBuffers(1, &tile_buffer_);
}

// Draws the whole plane, viewed from above, into a new texture: colour times light.
GLuint PlanePainter::PaintLight(const TexturedPlane& plane, const ShadowMap& shadow) const {
  const GlProgram program(std::string(kPaintHead) + shaders::kPlaneVertex,
                          std::string(kPaintHead) + shaders::kShadow + shaders::kPaintFragment);
  const GLuint colour = UploadTexture(plane.texture);
  glGenerateMipmap(GL_TEXTURE_2D);
  const int size_px = plane.texture.width_px < 1024 ? 1024 : plane.texture.width_px;
  const GLuint painted = UploadTexture({size_px, size_px, {}});
  GLuint frame = 0;
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, painted, 0);
  CheckFramebuffer("painted surface");
  glViewport(0, 0, size_px, size_px);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);

  Matrix4f clip_of_B = Matrix4f::Identity();
  clip_of_B(0, 0) = 2.0F / plane.size.x();
  clip_of_B(1, 1) = 2.0F / plane.size.y();
  clip_of_B(2, 2) = 0.0F;
  clip_of_B(0, 3) = -plane.centre_B.x() * clip_of_B(0, 0);
  clip_of_B(1, 3) = -plane.centre_B.y() * clip_of_B(1, 1);
  program.Use();
  program.Set("u_clip_of_B", clip_of_B);
  program.Set("u_tile_size", plane.size);
  program.Set("u_z", plane.centre_B.z());
  program.Set("u_uv_of_xy", TextureOfXy(plane, plane.tile));
  program.Set("u_texture", 0);
  program.Set("u_shadow", 1);
  program.Set("u_shadow_texel", 1.0F / kPaintedShadowMapPx);
  program.Set("u_sky", kSkyFromAbove);
  program.Set("u_sun", Vector3f(kSun_B.z() * kSunLight));
  SetShadowOfXy(program, shadow.map_of_B(), plane.centre_B.z());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, shadow.texture());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, colour);
  DrawTiles({LowCorner(plane)});

  glBindTexture(GL_TEXTURE_2D, painted);
  glGenerateMipmap(GL_TEXTURE_2D);
  glDeleteFramebuffers(1, &frame);
  glDeleteTextures(1, &colour);
  return painted;
}

std::vector<PaintedSurface> PlanePainter::Painted() const {
  std::vector<PaintedSurface> surfaces;
  for (const Plane& plane : planes_) {
    surfaces.push_back(ReadSurface(plane.texture));
  }
  return surfaces;
}

void PlanePainter::SortTiles(const Plane& plane, const Ball& target,
                             const std::vector<MovingBounds>& moving) const {
  lit_tiles_.clear();
  shaded_tiles_.clear();
  const Vector2f size = plane.shape.size.cwiseQuotient(
      Vector2f(static_cast<float>(plane.columns), static_cast<float>(plane.rows)));
  const float z = plane.shape.centre_B.z();
  darkened_.clear();
  const Vector2f reach = Vector2f::Constant(kDarkenedReach * target.radius);
  darkened_.emplace_back(target.p_B.head<2>() - reach, target.p_B.head<2>() + reach);
  for (const MovingBounds& thing : moving) {
    darkened_.push_back(ShadowOn(z, thing));
  }
  for (int row = 0; row < plane.rows; ++row) {
    for (int column = 0; column < plane.columns; ++column) {
      const Vector2f low = LowCorner(plane.shape) +
                           size.cwiseProduct(Vector2f(static_cast<float>(column), static_cast<float>(row)));
      const Rectangle tile(low, Vector2f(low + size));
      const bool shaded = std::any_of(darkened_.begin(), darkened_.end(),
                                      [&](const Rectangle& dark) { return dark.intersects(tile); });
      (shaded ? shaded_tiles_ : lit_tiles_).push_back(low);
    }
  }
}

void PlanePainter::DrawTiles(const std::vector<Vector2f>& tiles) const {
  if (tiles.empty()) {
    return;
  }
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, tile_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(tiles.size() * sizeof(Vector2f)), tiles.data(),
               GL_STREAM_DRAW);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(tiles.size()));
}

void PlanePainter::Draw(const Matrix4f& clip_of_B, float gain, const ShadowMap& shadow, const Ball& target,
                        const std::vector<MovingBounds>& moving, float bottom) const {
  const float sun = kSun_B.z() * kSunLight.mean();
  for (const Plane& plane : planes_) {
    if (plane.shape.centre_B.z() < bottom) {
      continue;
    }
    SortTiles(plane, target, moving);
    const Vector2f tile_size = plane.shape.size.cwiseQuotient(
        Vector2f(static_cast<float>(plane.columns), static_cast<float>(plane.rows)));
    const float z = plane.shape.centre_B.z();
    glBindTexture(GL_TEXTURE_2D, plane.texture);
    for (const bool shaded : {false, true}) {
      const GlProgram& program = shaded ? shaded_program_ : lit_program_;
      program.Use();
      program.Set("u_clip_of_B", clip_of_B);
      program.Set("u_tile_size", tile_size);
      program.Set("u_z", z);
      program.Set("u_uv_of_xy", TextureOfXy(plane.shape, plane.shape.size));
      program.Set("u_texture", 0);
      program.Set("u_gain", gain);
      if (shaded) {
        program.Set("u_shadow", 1);
        program.Set("u_shadow_texel", 1.0F / static_cast<float>(shadow.size_px()));
        program.Set("u_left", kSkyFromAbove.mean() / (kSkyFromAbove.mean() + sun));
        program.Set("u_ball", Vector3f(target.p_B - Vector3f(0.0F, 0.0F, z)));
        program.Set("u_ball_r2", target.radius * target.radius);
        SetShadowOfXy(program, shadow.map_of_B(), z);
      }
      DrawTiles(shaded ? shaded_tiles_ : lit_tiles_);
    }
  }
}

}  // namespace fovea::sim
