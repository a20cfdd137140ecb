#include "render/gl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "core/model/error.hpp"

namespace planescope::render {
namespace {

template <typename Handle, typename Generate>
Handle generate(Generate function) {
  GLuint id = 0;
  function(1, &id);
  return Handle(id);
}

/// What the driver says about a shader or a program, in one line.
template <typename Get, typename Log>
std::string info_log(GLuint id, Get get, Log log) {
  GLint length = 0;
  get(id, GL_INFO_LOG_LENGTH, &length);
  std::string text(static_cast<std::size_t>(length), ' ');
  log(id, length, nullptr, text.data());
  text = text.c_str();  // up to its end
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
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
  const std::string log = info_log(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  throw Error(fmt::format("the {} shader of '{}' does not compile: {}",
                          kind == GL_VERTEX_SHADER ? "vertex" : "fragment", name, log));
}

}  // namespace

GlBuffer make_buffer() { return generate<GlBuffer>(glGenBuffers); }
GlVertexArray make_vertex_array() { return generate<GlVertexArray>(glGenVertexArrays); }
GlTexture make_texture() { return generate<GlTexture>(glGenTextures); }
GlRenderbuffer make_renderbuffer() { return generate<GlRenderbuffer>(glGenRenderbuffers); }
GlFramebuffer make_framebuffer() { return generate<GlFramebuffer>(glGenFramebuffers); }

GlProgram make_program(const char* name, std::string_view vertex, std::string_view fragment) {
  GlProgram program(glCreateProgram());
  for (const auto& [kind, source] :
       {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
    const GLuint shader = compile(kind, name, source);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // lives on with the program
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  throw Error(fmt::format("the shaders of '{}' do not link: {}", name,
                          info_log(program, glGetProgramiv, glGetProgramInfoLog)));
}

void set_attribute(const Attribute& attribute) {
  // A place in the bound buffer, which OpenGL takes as a pointer.
  const void* offset =
      reinterpret_cast<const void*>(attribute.offset);  // NOLINT(performance-no-int-to-ptr)
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
  constexpr std::array kNames = {"GL_INVALID_ENUM",
                                 "GL_INVALID_VALUE",
                                 "GL_INVALID_OPERATION",
                                 "GL_STACK_OVERFLOW",
                                 "GL_STACK_UNDERFLOW",
                                 "GL_OUT_OF_MEMORY",
                                 "GL_INVALID_FRAMEBUFFER_OPERATION"};
  const GLenum code = glGetError();
  if (code == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  const std::size_t i = code - GL_INVALID_ENUM;
  throw Error(fmt::format("OpenGL reports {} in {}",
                          i < kNames.size() ? kNames[i] : "an unknown error", where));
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

// ---- Framebuffers ----

namespace {

GlRenderbuffer storage(int samples, GLenum format, int width, int height) {
  GlRenderbuffer buffer = make_renderbuffer();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  return buffer;
}

GlTexture texture(GLint format, GLenum channels, int width, int height) {
  GlTexture result = make_texture();
  glBindTexture(GL_TEXTURE_2D, result);
  glTexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, channels, GL_UNSIGNED_INT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return result;
}

void attach(GLenum point, const GlRenderbuffer& buffer) {
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, buffer);
}
void attach(GLenum point, const GlTexture& texture) {
  glFramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D, texture, 0);
}

template <typename Color, typename Depth>
GlFramebuffer framebuffer_of(const Color& color, const Depth& depth) {
  GlFramebuffer result = make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, result);
  attach(GL_COLOR_ATTACHMENT0, color);
  attach(GL_DEPTH_ATTACHMENT, depth);
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return result;
  throw Error(
      fmt::format("OpenGL cannot draw a picture of this size (framebuffer status {:#x})", status));
}

void check_size(int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width >= 1 && height >= 1 && width <= largest && height <= largest) return;
  throw Error(fmt::format("a picture of {} x {} pixels was asked for, expected 1 to {} each way",
                          width, height, largest));
}

}  // namespace

void SceneTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;  // until everything is made
  color = storage(samples, GL_RGBA8, new_width, new_height);
  depth = storage(samples, GL_DEPTH_COMPONENT24, new_width, new_height);
  box_depth = storage(samples, GL_DEPTH_COMPONENT24, new_width, new_height);
  scene = framebuffer_of(color, depth);
  boxes = framebuffer_of(color, box_depth);
  flat_depth = texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, new_width, new_height);
  flat_color = texture(GL_RGBA8, GL_RGBA, new_width, new_height);
  // Blending leaves meaningless values in the alpha channel.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_A, GL_ONE);
  glBindTexture(GL_TEXTURE_2D, 0);
  resolved = framebuffer_of(flat_color, flat_depth);
  width = new_width;
  height = new_height;
}

void IdTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;
  ids = storage(0, GL_R32UI, new_width, new_height);
  depth = storage(0, GL_DEPTH_COMPONENT24, new_width, new_height);
  framebuffer = framebuffer_of(ids, depth);
  width = new_width;
  height = new_height;
}

// ---- Images as textures ----

void ImageTexture::upload(const Image8& image) {
  assert(!image.empty() && (image.channels == 3 || image.channels == 4));
  GLint before = 0;
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &before);
  const bool same = width_ == image.width && height_ == image.height && channels_ == image.channels;
  if (texture_ == 0) texture_ = make_texture();
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const GLenum channels = image.channels == 3 ? GL_RGB : GL_RGBA;
  if (same) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, channels, GL_UNSIGNED_BYTE,
                    image.data.data());
  } else {
    glTexImage2D(GL_TEXTURE_2D, 0, image.channels == 3 ? GL_RGB8 : GL_RGBA8, image.width,
                 image.height, 0, channels, GL_UNSIGNED_BYTE, image.data.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(before));
  width_ = image.width;
  height_ = image.height;
  channels_ = image.channels;
  check_gl("uploading an image");
}

}  // namespace planescope::render
