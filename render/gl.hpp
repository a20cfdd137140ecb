#pragma once

// GL helpers shared by all passes: the entry points, owned objects, programs, buffers, framebuffers
// and images as textures.

#define GL_GLEXT_PROTOTYPES

/// The bytes of a file that planescope_embed() compiled in, by its symbol.
#define PLANESCOPE_ASSET_DECLARE(name)                      \
  extern "C" const unsigned char planescope_asset_##name[]; \
  extern "C" const unsigned char planescope_asset_##name##_end[]
#define PLANESCOPE_ASSET(name)                                \
  std::string_view(                                           \
      reinterpret_cast<const char*>(planescope_asset_##name), \
      static_cast<std::size_t>(planescope_asset_##name##_end - planescope_asset_##name))

#include <GL/glcorearb.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/model/types.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

/// Owns one GL object; moves only.
template <void (*Destroy)(GLuint)>
class GlHandle {
 public:
  GlHandle() = default;
  explicit GlHandle(GLuint id) : id_(id) {}
  GlHandle(GlHandle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlHandle() {
    if (id_ != 0) Destroy(id_);
  }
  operator GLuint() const { return id_; }  // NOLINT: as GL takes its names

 private:
  GLuint id_ = 0;
};
inline void destroy_buffer(GLuint id) { glDeleteBuffers(1, &id); }
inline void destroy_vertex_array(GLuint id) { glDeleteVertexArrays(1, &id); }
inline void destroy_texture(GLuint id) { glDeleteTextures(1, &id); }
inline void destroy_renderbuffer(GLuint id) { glDeleteRenderbuffers(1, &id); }
inline void destroy_framebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
inline void destroy_program(GLuint id) { glDeleteProgram(id); }
using GlBuffer = GlHandle<destroy_buffer>;
using GlVertexArray = GlHandle<destroy_vertex_array>;
using GlTexture = GlHandle<destroy_texture>;
using GlRenderbuffer = GlHandle<destroy_renderbuffer>;
using GlFramebuffer = GlHandle<destroy_framebuffer>;
using GlProgram = GlHandle<destroy_program>;

GlBuffer make_buffer();
GlVertexArray make_vertex_array();
GlTexture make_texture();
GlRenderbuffer make_renderbuffer();
GlFramebuffer make_framebuffer();
/// Throws Error with the driver's log where a shader does not compile or link.
GlProgram make_program(const char* name, std::string_view vertex, std::string_view fragment);

/// Describes one attribute of the bound array buffer. `per_instance`: steps once per instance.
struct Attribute {
  GLuint location = 0;
  GLint components = 1;
  GLenum type = GL_FLOAT;  // GL_UNSIGNED_BYTE is normalized to 0..1, GL_UNSIGNED_INT stays integer
  std::size_t stride = 0, offset = 0;
  bool per_instance = false;
};
void set_attribute(const Attribute& attribute);

/// Fills an array buffer, and leaves it bound.
template <typename Values>
void upload(const GlBuffer& buffer, const Values& values) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(std::span(values).size_bytes()),
               std::data(values), GL_STREAM_DRAW);
}

inline Eigen::Vector4f to_vector(Rgba color) {
  return Eigen::Vector4f(color.r, color.g, color.b, color.a) / 255.0f;
}
void set_uniform(GLuint program, const char* name, float value);
void set_uniform(GLuint program, const char* name, int value);
void set_uniform(GLuint program, const char* name, const Eigen::Vector2f& value);
void set_uniform(GLuint program, const char* name, const Eigen::Vector4f& value);
void set_uniform(GLuint program, const char* name, const Eigen::Matrix4f& value);

/// Throws Error naming `where` if GL has recorded an error since the last call.
void check_gl(const char* where);

/// Renderer and driver of the current context. Throws Error unless it is OpenGL 3.3 or later.
std::string gl_description();

/// Framebuffers of one picture, kept while its size stays the same.
struct SceneTarget {
  explicit SceneTarget(int samples_per_pixel) : samples(samples_per_pixel) {}

  int samples = 4;  // 0: no antialiasing
  int width = 0, height = 0;
  GlRenderbuffer color, depth, box_depth;
  GlFramebuffer scene;     // color + depth
  GlFramebuffer boxes;     // color + box_depth: boxes hide boxes, but nothing else
  GlTexture flat_color;    // the picture, opaque when sampled
  GlTexture flat_depth;    // of the points
  GlFramebuffer resolved;  // flat_color + flat_depth

  void resize(int new_width, int new_height);
};

struct IdTarget {
  int width = 0, height = 0;
  GlRenderbuffer ids, depth;
  GlFramebuffer framebuffer;

  void resize(int new_width, int new_height);
};

/// An image as a GL texture, row 0 at the top (texture coordinate v = 0). Shown larger than it is,
/// its pixels stay square. Needs the context that was current when it was made.
class ImageTexture {
 public:
  ImageTexture() = default;  // id() 0
  explicit ImageTexture(const Image8& image) { upload(image); }

  /// Replaces what it shows; quicker where the size stays. RGB or RGBA, not empty.
  void upload(const Image8& image);

  std::uint32_t id() const { return texture_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GlTexture texture_;
  int width_ = 0, height_ = 0, channels_ = 0;
};

}  // namespace planescope::render
