// SPDX-License-Identifier: Apache-2.0
// An OpenGL context without a window, by EGL: on a GPU if there is one, else in software.
#pragma once

#include <string>
#include <thread>

namespace fovea::sim {

class EglContext {
 public:
  // Creates context number `index` of this program, counted from 0; it is not yet current on any thread.
  // Prefers a GPU. Mesa's software renderer draws for one context per display at a time, so the first
  // contexts use different software displays if possible. std::runtime_error: no OpenGL 3.3 core context.
  explicit EglContext(int index);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  // Makes the context current on the calling thread; another thread must have released it before.
  void MakeCurrent();
  void Release();

  // The name of the renderer. The context must be current.
  [[nodiscard]] std::string RendererName() const;

 private:
  bool TryDisplay(void* display, std::string& reason);

  void* display_ = nullptr;
  void* context_ = nullptr;
  std::thread::id current_on_;
};

}  // namespace fovea::sim
