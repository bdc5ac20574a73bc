// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl_program.hpp"

#include <array>
#include <stdexcept>

namespace fovea::sim {
namespace {

GLuint Compile(GLenum stage, const std::string& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::array<char, 2048> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("the OpenGL driver refuses a shader: ") + log.data());
  }
  return shader;
}

}  // namespace

GlProgram::GlProgram(const std::string& vertex_source, const std::string& fragment_source) {
  const GLuint vertex = Compile(GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = Compile(GL_FRAGMENT_SHADER, fragment_source);
  program_ = glCreateProgram();
  glAttachShader(program_, vertex);
  glAttachShader(program_, fragment);
  glLinkProgram(program_);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint ok = GL_FALSE;
  glGetProgramiv(program_, GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) {
    throw std::runtime_error("the OpenGL driver refuses to link a program");
  }
}

GlProgram::~GlProgram() { glDeleteProgram(program_); }

GLint GlProgram::Location(const char* name) const {
  const auto found = locations_.find(name);
  if (found != locations_.end()) {
    return found->second;
  }
  const GLint location = glGetUniformLocation(program_, name);
  locations_.emplace(name, location);
  return location;
}

}  // namespace fovea::sim
