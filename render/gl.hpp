#pragma once

// What pictures are drawn with in OpenGL: owned objects, programs, buffers, framebuffers, images as
// textures, and the passes. A pass owns its programs and buffers and draws one kind of thing into
// the bound framebuffer; depth test, blending and masks are the renderer's to set.

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
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/model/types.hpp"
#include "render/paint.hpp"

namespace planescope::render {

/// Owns one GL object; moves only.
template <auto Delete, auto Generate = nullptr>
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
    if (id_ == 0) return;
    if constexpr (std::is_invocable_v<decltype(Delete), GLuint>)
      Delete(id_);
    else
      Delete(1, &id_);
  }
  static GlHandle make() {
    GLuint id = 0;
    Generate(1, &id);
    return GlHandle(id);
  }
  operator GLuint() const { return id_; }  // NOLINT: as GL takes its names

 private:
  GLuint id_ = 0;
};
using GlBuffer = GlHandle<glDeleteBuffers, glGenBuffers>;
using GlVertexArray = GlHandle<glDeleteVertexArrays, glGenVertexArrays>;
using GlTexture = GlHandle<glDeleteTextures, glGenTextures>;
using GlRenderbuffer = GlHandle<glDeleteRenderbuffers, glGenRenderbuffers>;
using GlFramebuffer = GlHandle<glDeleteFramebuffers, glGenFramebuffers>;
using GlProgram = GlHandle<glDeleteProgram>;

/// Throws Error with the driver's log where a shader does not compile or link.
GlProgram make_program(const char* name, std::string_view vertex, std::string_view fragment);

template <typename Value>
void set_uniform(GLuint program, const char* name, const Value& value) {
  const GLint at = glGetUniformLocation(program, name);
  if constexpr (std::is_same_v<Value, float>) glUniform1f(at, value);
  if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, bool>) glUniform1i(at, value);
  if constexpr (std::is_same_v<Value, Eigen::Vector2f>) glUniform2fv(at, 1, value.data());
  if constexpr (std::is_same_v<Value, Eigen::Matrix4f>)
    glUniformMatrix4fv(at, 1, GL_FALSE, value.data());
  if constexpr (std::is_same_v<Value, Rgba>)
    glUniform4f(at, value.r / 255.0f, value.g / 255.0f, value.b / 255.0f, value.a / 255.0f);
}

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

// ---- Passes ----

/// Color: into the picture. Id: into an attachment of 32-bit integers.
enum class Output { color, id };

/// What all passes have: a program for each output and a buffer of vertices or instances.
class Pass {
 protected:
  Pass(const char* name, std::string_view vertex, std::string_view fragment, std::string_view id);
  /// The program in use, with what the view tells it.
  const GlProgram& use(const View& view, Output output) const;
  template <typename Values>
  void draw_strips(const Values& instances) const;

  GlProgram color_, id_;
  GlVertexArray array_ = GlVertexArray::make();
  GlBuffer buffer_ = GlBuffer::make();
};

class PointPass : Pass {
 public:
  PointPass();
  void draw(const std::vector<DrawPoints>& clouds, const View& view, Output output);

 private:
  GlBuffer colors_ = GlBuffer::make(), ids_ = GlBuffer::make();
};

/// Faces of boxes.
class BoxPass : Pass {
 public:
  BoxPass();
  /// `hatch_period_px`: distance of the hatching's stripes along a row of the picture.
  void draw(const std::vector<DrawBox>& boxes,
            const View& view,
            float face_alpha,
            float hatch_period_px,
            Output output);
};

class SegmentPass : Pass {
 public:
  SegmentPass();
  void draw(const std::vector<Segment>& segments, const View& view, Rgba halo, Output output);
  /// In pixels from the top left corner of the picture.
  void draw_flat(const std::vector<Segment>& segments, int width, int height);
};

/// Fills of polygons, in the order given.
class PolygonPass : Pass {
 public:
  PolygonPass();
  void draw(const std::vector<const DrawPolygon*>& polygons,
            const View& view,
            float bias_m,
            Output output);
};

void append_edges(const DrawBox& box, const View& view, std::vector<Segment>& segments);
/// Of a convex polygon; of others nothing.
void append_outline(const DrawPolygon& polygon, float bias_m, std::vector<Segment>& segments);

/// Shapes of the overlay, in pixels from the top left corner of the picture.
class ShapePass : Pass {
 public:
  ShapePass();
  void draw(const std::vector<OverlayShape>& shapes, const View& view);
};

/// Text of the overlay, from an atlas that gathers the glyphs as they are met.
class TextPass : Pass {
 public:
  TextPass();
  void draw(const std::vector<OverlayText>& texts, const View& view);

 private:
  struct Key {
    char32_t codepoint = 0;
    int size_q = 0;  // 1/16 px
    int phase = 0;
    int halo_q = 0;  // 1/16 px
    auto operator<=>(const Key&) const = default;
  };
  struct Entry {
    int x = 0, y = 0;  // in the atlas
    int width = 0, height = 0;
    int left = 0, top = 0;
  };
  struct Instance {
    float x = 0, y = 0, width = 0, height = 0;
    float atlas_x = 0, atlas_y = 0;
    Rgba color;
  };

  bool append(const OverlayText& text, std::vector<Instance>& instances);
  const Entry* entry(const Key& key);
  void clear_atlas(int height);

  static constexpr int kAtlasWidth = 1024;
  int atlas_height_ = 0;
  std::vector<std::uint8_t> atlas_;
  bool atlas_changed_ = false;
  int shelf_x_ = 0, shelf_y_ = 0, shelf_height_ = 0;
  std::map<Key, Entry> entries_;
  GlTexture texture_ = GlTexture::make();
};

// ---- Points on the CPU ----
// With a software GL they are most of a picture's cost, and pictures of one frame show the same
// points in other colors. Same shapes and shading as points.vert, points.frag and shade.frag draw
// in a window, at the same four samples a pixel.

/// Which points are seen where, whatever their colors. Rows from the bottom, as GL counts them.
struct SplatLayer {
  struct Part {
    std::uint32_t point = 0;  // counted through all clouds
    float share = 0;          // of the pixel, less at the splat's darker rim
  };
  int width = 0, height = 0;
  std::vector<float> distances;      // along the view at a pixel's first sample [m]; or infinite
  std::vector<float> light;          // by how much a pixel's neighbors darken it, 1: not at all
  std::vector<std::uint8_t> counts;  // parts of each pixel, 0 to 4
  std::vector<float> bare;           // share of a pixel with parts that no point covers
  std::vector<Part> parts;           // of all pixels
};
/// How far beside a pixel lies what darkens it, here and in shade.frag [px].
float shade_radius_px(const View& view);

SplatLayer splat(const std::vector<DrawPoints>& clouds, const View& view);

/// Their picture on the theme's background: RGBA, opaque, row 0 at the bottom.
Image8 paint(const SplatLayer& layer,
             const std::vector<DrawPoints>& clouds,
             const ThemeColors& theme);

/// Of each pixel as GL has it: from 0 at the near plane to 2^32 - 1 at the far one.
std::vector<std::uint32_t> depths(const SplatLayer& layer, const View& view);

/// Where these are equal, so are the layers.
bool same_shapes(const std::vector<DrawPoints>& a, const std::vector<DrawPoints>& b);

}  // namespace planescope::render
