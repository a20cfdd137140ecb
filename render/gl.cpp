#include "render/gl.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cstring>
#include <initializer_list>
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

// ---- Framebuffers ----

namespace {

struct Attachment {
  GLenum point = GL_COLOR_ATTACHMENT0;
  GLuint renderbuffer = 0;
};

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

GlFramebuffer framebuffer(std::initializer_list<Attachment> attachments) {
  GlFramebuffer result = make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, result);
  for (const Attachment& attachment : attachments) {
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment.point, GL_RENDERBUFFER,
                              attachment.renderbuffer);
  }
  return result;
}

void check_complete(const char* what, int width, int height) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return;
  throw Error(fmt::format("OpenGL cannot draw a {} of {} x {} pixels (framebuffer status {:#x})",
                          what, width, height, status));
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
  scene = framebuffer({{GL_COLOR_ATTACHMENT0, color}, {GL_DEPTH_ATTACHMENT, depth}});
  check_complete("picture", new_width, new_height);
  boxes = framebuffer({{GL_COLOR_ATTACHMENT0, color}, {GL_DEPTH_ATTACHMENT, box_depth}});
  check_complete("picture", new_width, new_height);

  flat_depth = texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, new_width, new_height);
  flat_color = texture(GL_RGBA8, GL_RGBA, new_width, new_height);
  // Blending leaves meaningless values in the alpha channel.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_A, GL_ONE);
  glBindTexture(GL_TEXTURE_2D, 0);
  resolved = framebuffer({});
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, flat_color, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, flat_depth, 0);
  check_complete("picture", new_width, new_height);
  width = new_width;
  height = new_height;
}

void PictureTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;
  depth = texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, new_width, new_height);
  color = texture(GL_RGBA8, GL_RGBA, new_width, new_height);
  glBindTexture(GL_TEXTURE_2D, 0);
  box_depth = storage(0, GL_DEPTH_COMPONENT24, new_width, new_height);
  scene = framebuffer({});
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  check_complete("picture", new_width, new_height);
  boxes = framebuffer({{GL_DEPTH_ATTACHMENT, box_depth}});
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
  check_complete("picture", new_width, new_height);
  width = new_width;
  height = new_height;
}

void IdTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;
  ids = storage(0, GL_R32UI, new_width, new_height);
  depth = storage(0, GL_DEPTH_COMPONENT24, new_width, new_height);
  framebuffer =
      planescope::render::framebuffer({{GL_COLOR_ATTACHMENT0, ids}, {GL_DEPTH_ATTACHMENT, depth}});
  check_complete("picking buffer", new_width, new_height);
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
