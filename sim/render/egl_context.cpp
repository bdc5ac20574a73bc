// SPDX-License-Identifier: Apache-2.0
#include "sim/render/egl_context.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace fovea::sim {
namespace {

constexpr const char* kAdvice =
    "no EGL: the camera cannot be rendered; install a driver (Debian: libegl1 and libgl1-mesa-dri)";

std::string ErrorText() { return fmt::format("EGL error 0x{:x}", eglGetError()); }

bool Has(const char* extensions, const char* name) {
  return extensions != nullptr && std::string(extensions).find(name) != std::string::npos;
}

// Displays that may be able to render, by kind.
struct Displays {
  std::vector<void*> gpu;
  std::vector<void*> software;
};

Displays FindDisplays() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (extensions == nullptr) {
    throw std::runtime_error(fmt::format("{} ({})", kAdvice, ErrorText()));
  }
  Displays displays;
  if (!Has(extensions, "EGL_EXT_platform_base")) {
    return displays;
  }
  if (Has(extensions, "EGL_MESA_platform_surfaceless")) {
    displays.software.push_back(
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  if (Has(extensions, "EGL_EXT_platform_device") && Has(extensions, "EGL_EXT_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint num_devices = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &num_devices);
    for (EGLint i = 0; i < num_devices; ++i) {
      EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
      void* display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
      const bool is_software =
          Has(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
      (is_software ? displays.software : displays.gpu).push_back(display);
    }
  }
  return displays;
}

}  // namespace

EglContext::EglContext(int index) {
  const Displays displays = FindDisplays();
  std::string reason = "no usable display";
  for (void* display : displays.gpu) {
    if (TryDisplay(display, reason)) {
      return;
    }
  }
  const std::size_t count = displays.software.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (TryDisplay(displays.software[(static_cast<std::size_t>(index) + i) % count], reason)) {
      return;
    }
  }
  throw std::runtime_error(fmt::format("{} ({})", kAdvice, reason));
}

bool EglContext::TryDisplay(void* display, std::string& reason) {
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    reason = ErrorText();
    return false;
  }
  constexpr std::array<EGLint, 7> kAttributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_MINOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                 EGL_NONE};
  EGLContext context = EGL_NO_CONTEXT;
  if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE) {
    context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
  }
  if (context == EGL_NO_CONTEXT) {
    reason = "no OpenGL 3.3 core context, " + ErrorText();
    return false;
  }
  display_ = display;
  context_ = context;
  return true;
}

EglContext::~EglContext() {
  if (display_ != nullptr) {
    // The display is not terminated: all contexts of the process share it.
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
}

void EglContext::MakeCurrent() {
  if (current_on_ == std::this_thread::get_id()) {
    return;
  }
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
    throw std::runtime_error("the OpenGL context cannot be made current, " + ErrorText());
  }
  current_on_ = std::this_thread::get_id();
}

void EglContext::Release() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  current_on_ = std::thread::id();
}

std::string EglContext::RendererName() const {
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

}  // namespace fovea::sim
