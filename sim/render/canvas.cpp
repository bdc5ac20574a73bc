// SPDX-License-Identifier: Apache-2.0
#include "sim/render/canvas.hpp"

#include <cstddef>
#include <string>

#include "sim/render/gpu_mesh.hpp"
#include "sim/render/shaders.hpp"

namespace fovea::sim {
namespace {

const char* const kAreaHead = "#version 330 core\n";

}  // namespace

Canvas::Canvas(int width_px, int height_px, int samples)
    : width_px_(width_px),
      height_px_(height_px),
      multisampled_(samples > 1),
      area_program_(std::string(kAreaHead) + shaders::kAreaVertex,
                    std::string(kAreaHead) + shaders::kShadowFragment) {
  glGenVertexArrays(1, &area_array_);
  glGenBuffers(1, &area_buffer_);
  glBindVertexArray(area_array_);
  glBindBuffer(GL_ARRAY_BUFFER, area_buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribIPointer(0, 4, GL_INT, sizeof(PictureArea), nullptr);
  glVertexAttribDivisor(0, 1);
  glGenFramebuffers(2, frames_);
  glGenRenderbuffers(3, buffers_);
  const auto attach = [&](GLuint buffer, GLenum format, GLenum point, int count) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, count, format, width_px, height_px);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, buffer);
  };
  const int count = multisampled_ ? samples : 0;
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
  attach(buffers_[0], GL_RGBA8, GL_COLOR_ATTACHMENT0, count);
  attach(buffers_[1], GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, count);
  CheckFramebuffer("picture");
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[1]);
  attach(buffers_[2], GL_RGBA8, GL_COLOR_ATTACHMENT0, 0);
  CheckFramebuffer("resolved picture");
}

Canvas::~Canvas() {
  glDeleteVertexArrays(1, &area_array_);
  glDeleteBuffers(1, &area_buffer_);
  glDeleteFramebuffers(2, frames_);
  glDeleteRenderbuffers(3, buffers_);
}

void Canvas::Bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
  glViewport(0, 0, width_px_, height_px_);
}

void Canvas::DrawOnly(std::span<const PictureArea> areas) const {
  static_assert(sizeof(PictureArea) == 4 * sizeof(GLint), "an instance's four numbers");
  glClearDepth(0.0);  // nothing is nearer
  glClear(GL_DEPTH_BUFFER_BIT);
  glClearDepth(1.0);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  glDisable(GL_CULL_FACE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  area_program_.Use();
  area_program_.Set("u_size_px",
                    Eigen::Vector2f(static_cast<float>(width_px_), static_cast<float>(height_px_)));
  glBindVertexArray(area_array_);
  glBindBuffer(GL_ARRAY_BUFFER, area_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(areas.size_bytes()), areas.data(), GL_STREAM_DRAW);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(areas.size()));
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthFunc(GL_LESS);
}

void Canvas::Resolve() const {
  if (multisampled_) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[0]);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frames_[1]);
    glBlitFramebuffer(0, 0, width_px_, height_px_, 0, 0, width_px_, height_px_, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[1]);
  }
}

void Canvas::Read(int begin_px, int rows, std::span<std::uint8_t> rgba) const {
  const std::size_t offset =
      std::size_t{4} * static_cast<std::size_t>(begin_px) * static_cast<std::size_t>(width_px_);
  glReadPixels(0, begin_px, width_px_, rows, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data() + offset);
}

}  // namespace fovea::sim
