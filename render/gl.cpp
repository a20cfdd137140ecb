#include "render/gl.hpp"

#include <fmt/format.h>

#include <cstring>
#include <vector>

#include "core/model/error.hpp"

namespace planescope::render {
namespace {

template <typename Handle, typename Generate>
Handle generate(Generate function) {
  GLuint id = 0;
  function(1, &id);
  return Handle(id);
}

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

GLuint compile(GLenum kind, const char* name, std::string_view source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.data();
  const GLint length = static_cast<GLint>(source.size());
  glShaderSource(shader, 1, &text, &length);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  GLint log_length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &log_length);
  std::string log(static_cast<std::size_t>(log_length), ' ');
  glGetShaderInfoLog(shader, log_length, nullptr, log.data());
  glDeleteShader(shader);
  throw Error(fmt::format("the {} shader of '{}' does not compile: {}",
                          kind == GL_VERTEX_SHADER ? "vertex" : "fragment", name,
                          one_line(log.c_str())));
}

const char* gl_error_name(GLenum code) {
  switch (code) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "an unknown error";
  }
}

}  // namespace

GlBuffer make_buffer() { return generate<GlBuffer>(glGenBuffers); }
GlVertexArray make_vertex_array() { return generate<GlVertexArray>(glGenVertexArrays); }
GlTexture make_texture() { return generate<GlTexture>(glGenTextures); }
GlRenderbuffer make_renderbuffer() { return generate<GlRenderbuffer>(glGenRenderbuffers); }
GlFramebuffer make_framebuffer() { return generate<GlFramebuffer>(glGenFramebuffers); }

GlProgram make_program(const char* name, std::string_view vertex, std::string_view fragment) {
  GlProgram program(glCreateProgram());
  const GLuint vertex_shader = compile(GL_VERTEX_SHADER, name, vertex);
  glAttachShader(program, vertex_shader);
  glDeleteShader(vertex_shader);  // lives on with the program
  const GLuint fragment_shader = compile(GL_FRAGMENT_SHADER, name, fragment);
  glAttachShader(program, fragment_shader);
  glDeleteShader(fragment_shader);
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  GLint log_length = 0;
  glGetProgramiv(program, GL_INFO_LOG_LENGTH, &log_length);
  std::string log(static_cast<std::size_t>(log_length), ' ');
  glGetProgramInfoLog(program, log_length, nullptr, log.data());
  throw Error(fmt::format("the shaders of '{}' do not link: {}", name, one_line(log.c_str())));
}

void set_attribute(const Attribute& attribute) {
  const void* offset = reinterpret_cast<const void*>(attribute.offset);
  const GLsizei stride = static_cast<GLsizei>(attribute.stride);
  glEnableVertexAttribArray(attribute.location);
  if (attribute.type == GL_UNSIGNED_INT) {
    glVertexAttribIPointer(attribute.location, attribute.components, attribute.type, stride,
                           offset);
  } else {
    const GLboolean normalised = attribute.type == GL_UNSIGNED_BYTE ? GL_TRUE : GL_FALSE;
    glVertexAttribPointer(attribute.location, attribute.components, attribute.type, normalised,
                          stride, offset);
  }
  glVertexAttribDivisor(attribute.location, attribute.per_instance ? 1 : 0);
}

void set_uniform(GLuint program, const char* name, float value) {
  glUniform1f(glGetUniformLocation(program, name), value);
}
void set_uniform(GLuint program, const char* name, int value) {
  glUniform1i(glGetUniformLocation(program, name), value);
}
void set_uniform(GLuint program, const char* name, const Eigen::Vector2f& value) {
  glUniform2fv(glGetUniformLocation(program, name), 1, value.data());
}
void set_uniform(GLuint program, const char* name, const Eigen::Vector4f& value) {
  glUniform4fv(glGetUniformLocation(program, name), 1, value.data());
}
void set_uniform(GLuint program, const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, value.data());
}

void check_gl(const char* where) {
  const GLenum code = glGetError();
  if (code == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  throw Error(fmt::format("OpenGL reports {} in {}", gl_error_name(code), where));
}

std::string gl_description() {
  const auto text = [](GLenum what) {
    const GLubyte* value = glGetString(what);
    return value != nullptr ? std::string(reinterpret_cast<const char*>(value)) : std::string("?");
  };
  GLint major = 0;
  GLint minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (major < 3 || (major == 3 && minor < 3)) {
    throw Error(fmt::format("OpenGL of {} is version '{}', expected 3.3 core", text(GL_RENDERER),
                            text(GL_VERSION)));
  }
  // "4.5 (Core Profile) Mesa 22.3.6" -> "Mesa 22.3.6"
  std::string version = text(GL_VERSION);
  if (const std::size_t at = version.find("(Core Profile) "); at != std::string::npos) {
    version = version.substr(at + std::strlen("(Core Profile) "));
  }
  return text(GL_RENDERER) + ", " + version;
}

}  // namespace planescope::render
