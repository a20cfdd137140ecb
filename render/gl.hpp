#pragma once

// The little of GL that every pass shares: the entry points, owned objects, programs.

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "render/draw_list.hpp"

/// The bytes of a file that planescope_embed() compiled in, by its symbol.
#define PLANESCOPE_ASSET_DECLARE(name)                      \
  extern "C" const unsigned char planescope_asset_##name[]; \
  extern "C" const unsigned char planescope_asset_##name##_end[]
#define PLANESCOPE_ASSET(name)                                \
  std::string_view(                                           \
      reinterpret_cast<const char*>(planescope_asset_##name), \
      static_cast<std::size_t>(planescope_asset_##name##_end - planescope_asset_##name))

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
  operator GLuint() const { return id_; }

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
  GLenum type = GL_FLOAT;  // GL_UNSIGNED_BYTE is normalised to 0..1, GL_UNSIGNED_INT stays integer
  std::size_t stride = 0, offset = 0;
  bool per_instance = false;
};
void set_attribute(const Attribute& attribute);

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

}  // namespace planescope::render
