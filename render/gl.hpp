#pragma once

// OpenGL building blocks: owned objects, programs, buffers, framebuffers, image textures and
// passes. A pass owns its programs and buffers, and draws one kind of object into the bound
// framebuffer; depth test, blending and masks are set by the renderer.

#define GL_GLEXT_PROTOTYPES

/// Contents of a file embedded by planescope_embed(), by symbol.
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

/// Owns one GL object; move-only.
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
  operator GLuint() const { return id_; }  // NOLINT: convenient for GL calls

 private:
  GLuint id_ = 0;
};
using GlBuffer = GlHandle<glDeleteBuffers, glGenBuffers>;
using GlVertexArray = GlHandle<glDeleteVertexArrays, glGenVertexArrays>;
using GlTexture = GlHandle<glDeleteTextures, glGenTextures>;
using GlRenderbuffer = GlHandle<glDeleteRenderbuffers, glGenRenderbuffers>;
using GlFramebuffer = GlHandle<glDeleteFramebuffers, glGenFramebuffers>;
using GlProgram = GlHandle<glDeleteProgram>;

/// Throws Error with the driver's log if a shader does not compile or link.
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

/// Throws Error naming `where` if GL recorded an error since the last call.
void check_gl(const char* where);

/// Renderer and driver of the current context. Throws Error for versions below OpenGL 3.3.
std::string gl_description();

/// Framebuffers of a picture, reused while its size is unchanged.
struct SceneTarget {
  explicit SceneTarget(int samples_per_pixel) : samples(samples_per_pixel) {}

  int samples = 4;  // 0: no antialiasing
  int width = 0, height = 0;
  GlRenderbuffer color, depth, box_depth;
  GlFramebuffer scene;     // color + depth
  GlFramebuffer boxes;     // color + box_depth: boxes occlude only boxes
  GlTexture flat_color;    // the picture; opaque when sampled
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

/// An image as a GL texture, row 0 at the top (texture coordinate v = 0). Magnified pixels stay
/// square. Requires the context that was current at construction.
class ImageTexture {
 public:
  ImageTexture() = default;  // id() 0
  explicit ImageTexture(const Image8& image) { upload(image); }

  /// Replaces the image; faster if the size is unchanged. RGB or RGBA, not empty.
  void upload(const Image8& image);

  std::uint32_t id() const { return texture_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GlTexture texture_;
  int width_ = 0, height_ = 0, channels_ = 0;
};

// ---- Passes ----

/// Color: draw the picture. Id: draw ids into a 32-bit integer attachment.
enum class Output { color, id };

/// Common parts of all passes: a program per output and a buffer of vertices or instances.
class Pass {
 protected:
  Pass(const char* name, std::string_view vertex, std::string_view fragment, std::string_view id);
  /// Activates the program and sets its view uniforms.
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
  /// `hatch_period_px`: horizontal period of the hatching.
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
  /// Coordinates in pixels from the top left corner of the picture.
  void draw_flat(const std::vector<Segment>& segments, int width, int height);
};

/// Filled polygons, in the given order.
class PolygonPass : Pass {
 public:
  PolygonPass();
  void draw(const std::vector<const DrawPolygon*>& polygons,
            const View& view,
            float bias_m,
            Output output);
};

void append_edges(const DrawBox& box, const View& view, std::vector<Segment>& segments);
/// For convex polygons; does nothing for others.
void append_outline(const DrawPolygon& polygon, float bias_m, std::vector<Segment>& segments);

/// Shapes of the overlay, in pixels from the top left corner of the picture.
class ShapePass : Pass {
 public:
  ShapePass();
  void draw(const std::vector<OverlayShape>& shapes, const View& view);
};

/// Text of the overlay, from a glyph atlas that is filled on demand.
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
// With a software GL, points take most of the time of a picture, and pictures of a frame often show
// the same points in other colors. Shapes and shading match points.vert, points.frag and
// shade.frag, as used in windows, with the same four samples per pixel.

/// Visible points per pixel, independent of color. Rows from the bottom, as in GL.
struct SplatLayer {
  struct Part {
    std::uint32_t point = 0;  // index over all clouds
    float share = 0;          // share of the pixel, reduced at the splat's darker rim
  };
  int width = 0, height = 0;
  std::vector<float> distances;      // along the view at a pixel's first sample [m]; infinite
                                     // if empty
  std::vector<float> light;          // shading factor from a pixel's neighbors; 1: unshaded
  std::vector<std::uint8_t> counts;  // number of parts per pixel, 0 to 4
  std::vector<float> bare;           // uncovered share of a pixel with parts
  std::vector<Part> parts;           // of all pixels
};
/// Radius of the neighborhood that shades a pixel, here and in shade.frag [px].
float shade_radius_px(const View& view);

SplatLayer splat(const std::vector<DrawPoints>& clouds, const View& view);

/// Colors a layer on the theme's background: RGBA, opaque, row 0 at the bottom.
Image8 paint(const SplatLayer& layer,
             const std::vector<DrawPoints>& clouds,
             const ThemeColors& theme);

/// GL depth of each pixel: 0 at the near plane to 2^32 - 1 at the far plane.
std::vector<std::uint32_t> depths(const SplatLayer& layer, const View& view);

/// If true, the layers are equal.
bool same_shapes(const std::vector<DrawPoints>& a, const std::vector<DrawPoints>& b);

}  // namespace planescope::render
