// SPDX-License-Identifier: Apache-2.0
// A linked OpenGL program and its uniforms by name.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <string>
#include <unordered_map>

namespace fovea::sim {

class GlProgram {
 public:
  // std::runtime_error with the compiler's message if the sources do not compile or link.
  GlProgram(const std::string& vertex_source, const std::string& fragment_source);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void Use() const { glUseProgram(program_); }
  // Sets a uniform of the program in use. Ignores a uniform that the compiler removed as unused.
  void Set(const char* name, int value) const { glUniform1i(Location(name), value); }
  void Set(const char* name, float value) const { glUniform1f(Location(name), value); }
  void Set(const char* name, const Eigen::Vector2f& v) const { glUniform2fv(Location(name), 1, v.data()); }
  void Set(const char* name, const Eigen::Vector3f& v) const { glUniform3fv(Location(name), 1, v.data()); }
  void Set(const char* name, const Eigen::Vector4f& v) const { glUniform4fv(Location(name), 1, v.data()); }
  void Set(const char* name, const Eigen::Matrix4f& m) const {
    glUniformMatrix4fv(Location(name), 1, GL_FALSE, m.data());
  }

 private:
  [[nodiscard]] GLint Location(const char* name) const;

  GLuint program_ = 0;
  mutable std::unordered_map<std::string, GLint> locations_;
};

}  // namespace fovea::sim
