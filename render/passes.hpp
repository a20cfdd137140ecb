#pragma once

// The passes of a picture: each owns its programs and buffers, and draws one kind of thing into the
// bound framebuffer. Depth test, blending and masks are the renderer's to set.

#include <cstddef>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "render/gl.hpp"
#include "render/overlay.hpp"

namespace planescope::render {

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
  GlVertexArray array_ = make_vertex_array();
  GlBuffer buffer_ = make_buffer();
};

class PointPass : Pass {
 public:
  PointPass();
  void draw(const std::vector<DrawPoints>& clouds, const View& view, Output output);

 private:
  GlBuffer colors_ = make_buffer(), ids_ = make_buffer();
};

/// Faces of boxes.
class BoxPass : Pass {
 public:
  BoxPass();
  /// `hatch_period_px`: distance of the hatching's stripes along a row of the picture.
  void draw(std::span<const DrawBox> boxes,
            const View& view,
            float face_alpha,
            float hatch_period_px,
            Output output);
};

class SegmentPass : Pass {
 public:
  SegmentPass();
  void draw(std::span<const Segment> segments, const View& view, Rgba halo, Output output);
  /// In pixels from the top left corner of the picture.
  void draw_flat(std::span<const Segment> segments, int width, int height);
};

/// Fills of polygons, in the order given.
class PolygonPass : Pass {
 public:
  PolygonPass();
  void draw(std::span<const DrawPolygon* const> polygons,
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
  void draw(std::span<const OverlayShape> shapes, const View& view);
};

/// Text of the overlay, from an atlas that gathers the glyphs as they are met.
class TextPass : Pass {
 public:
  TextPass();
  void draw(std::span<const OverlayText> texts, const View& view);

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
  void upload_atlas();

  static constexpr int kAtlasWidth = 1024;
  int atlas_height_ = 0;
  std::vector<std::uint8_t> atlas_;
  bool atlas_changed_ = false;
  int shelf_x_ = 0, shelf_y_ = 0, shelf_height_ = 0;
  std::map<Key, Entry> entries_;
  GlTexture texture_ = make_texture();
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
