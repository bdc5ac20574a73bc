// SPDX-License-Identifier: Apache-2.0
#include "sim/render/shadow_map.hpp"

#include <string>

#include "sim/render/light.hpp"
#include "sim/render/shaders.hpp"

namespace fovea::sim {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3f;

constexpr float kHalfSize = 1.05F;  // half side of the square that the map covers around the centre [m]
constexpr float kHalfDepth = 2.0F;  // covered depth towards the sun and away from it [m]
const Vector3f kCentre_B(0.40F, 0.0F, 0.25F);

// Orthographic, looking along -sun.
Matrix4f ClipOfB(const Vector3f& sun_B) {
  const Vector3f z = -sun_B;
  const Vector3f x = z.cross(Vector3f::UnitZ()).normalized();
  const Vector3f y = z.cross(x);
  Matrix4f clip = Matrix4f::Identity();
  clip.block<1, 3>(0, 0) = x.transpose() / kHalfSize;
  clip.block<1, 3>(1, 0) = y.transpose() / kHalfSize;
  clip.block<1, 3>(2, 0) = z.transpose() / kHalfDepth;
  clip.block<3, 1>(0, 3) = -(clip.block<3, 3>(0, 0) * kCentre_B);
  return clip;
}

}  // namespace

ShadowMap::ShadowMap(int size_px)
    : size_px_(size_px),
      program_(std::string("#version 330 core\n") + shaders::kShadowVertex,
               std::string("#version 330 core\n") + shaders::kShadowFragment),
      clip_of_B_(ClipOfB(kSun_B)) {
  Matrix4f to_map = Matrix4f::Identity() * 0.5F;
  to_map.block<3, 1>(0, 3).setConstant(0.5F);
  to_map(3, 3) = 1.0F;
  map_of_B_ = to_map * clip_of_B_;

  glGenTextures(2, maps_);
  glGenFramebuffers(2, frames_);
  for (int i = 0; i < 2; ++i) {
    glBindTexture(GL_TEXTURE_2D, maps_[i]);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, size_px, size_px, 0, GL_DEPTH_COMPONENT,
                 GL_UNSIGNED_INT, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[i]);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, maps_[i], 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    CheckFramebuffer("shadow map");
  }
}

ShadowMap::~ShadowMap() {
  glDeleteFramebuffers(2, frames_);
  glDeleteTextures(2, maps_);
}

float ShadowMap::texel_m() const { return 2.0F * kHalfSize / static_cast<float>(size_px_); }

void ShadowMap::Draw(const DrawAll& draw_all) const {
  glViewport(0, 0, size_px_, size_px_);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);  // y of the map runs down, as in a picture
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5F, 4.0F);
  program_.Use();
  program_.Set("u_clip_of_B", clip_of_B_);
  draw_all([this](const GpuMesh& mesh, const Matrix4f& B_of_mesh) {
    program_.Set("u_B_of_mesh", B_of_mesh);
    mesh.Draw();
  });
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void ShadowMap::DrawStatic(const DrawAll& draw_all) {
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
  glClear(GL_DEPTH_BUFFER_BIT);
  Draw(draw_all);
}

void ShadowMap::DrawMoving(const DrawAll& draw_all) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[0]);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frames_[1]);
  glBlitFramebuffer(0, 0, size_px_, size_px_, 0, 0, size_px_, size_px_, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[1]);
  Draw(draw_all);
}

}  // namespace fovea::sim
