// SPDX-License-Identifier: Apache-2.0
#include "sim/render/canvas.hpp"

#include <cstddef>

#include "sim/render/gpu_mesh.hpp"

namespace fovea::sim {

Canvas::Canvas(int width_px, int height_px, int samples)
    : width_px_(width_px), height_px_(height_px), multisampled_(samples > 1) {
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
  glDeleteFramebuffers(2, frames_);
  glDeleteRenderbuffers(3, buffers_);
}

void Canvas::Bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
  glViewport(0, 0, width_px_, height_px_);
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
