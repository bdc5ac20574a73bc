// An OpenGL context without a window, by EGL: on a GPU where there is one, in software where there is none.
#pragma once

#include <string>
#include <thread>

namespace fovea::sim {

class EglContext {
 public:
  // The `index`-th context of this program, counted from 0. A GPU is taken where there is one. Mesa's
  // software renderer draws for one context of a display at a time, so each of the first contexts takes a
  // software display of its own as far as there are some. std::runtime_error with one line when no OpenGL 3.3
  // core context can be had. The context is not current anywhere yet.
  explicit EglContext(int index);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  // Makes the context current on the calling thread; another thread must have released it before.
  void MakeCurrent();
  void Release();

  // The name of what renders; needs the context to be current.
  [[nodiscard]] std::string RendererName() const;

 private:
  bool TryDisplay(void* display, std::string& reason);

  void* display_ = nullptr;
  void* context_ = nullptr;
  std::thread::id current_on_;
};

}  // namespace fovea::sim
