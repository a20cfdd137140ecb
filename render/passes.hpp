#pragma once

// The passes of a picture: each owns its programs and buffers, and draws one kind of thing into the
// bound framebuffer. Depth test, blending and masks are the renderer's to set.

#include <cstddef>
#include <span>
#include <vector>

#include "render/draw_list.hpp"
#include "render/gl.hpp"
#include "render/view.hpp"

namespace planescope::render {

/// Color: into the picture. Id: into an attachment of 32-bit integers.
enum class Output { color, id };

class PointPass {
 public:
  PointPass();
  void draw(const std::vector<DrawPoints>& clouds, const View& view, Output output);

 private:
  GlProgram color_, id_;
  GlVertexArray array_;
  GlBuffer positions_, colors_, ids_;
};

/// Faces of boxes.
class BoxPass {
 public:
  BoxPass();
  /// `hatch_period_px`: distance of the hatching's stripes along a row of the picture.
  void draw(std::span<const DrawBox> boxes,
            const View& view,
            float face_alpha,
            float hatch_period_px,
            Output output);

 private:
  GlProgram color_, id_;
  GlVertexArray array_;
  GlBuffer instances_;
};

/// A line or arrow of constant width on screen.
struct Segment {
  Vec3f a, b;
  Rgba color;
  float width_px = 1;
  float arrow = 0;   // 1: with a head at b
  float bias_m = 0;  // drawn this much nearer to the eye
  std::uint32_t id = 0;
};

class SegmentPass {
 public:
  SegmentPass();
  void draw(std::span<const Segment> segments, const View& view, Rgba halo, Output output);
  /// In pixels from the top left corner of the picture.
  void draw_flat(std::span<const Segment> segments, int width, int height);

 private:
  GlProgram color_, id_;
  GlVertexArray array_;
  GlBuffer instances_;
};

/// Fills of polygons, in the order given.
class PolygonPass {
 public:
  PolygonPass();
  void draw(std::span<const DrawPolygon* const> polygons,
            const View& view,
            float bias_m,
            Output output);

 private:
  GlProgram color_, id_;
  GlVertexArray array_;
  GlBuffer vertices_;
};

void append_edges(const DrawBox& box, const View& view, std::vector<Segment>& segments);
/// Of a convex polygon; of others nothing.
void append_outline(const DrawPolygon& polygon, float bias_m, std::vector<Segment>& segments);

}  // namespace planescope::render
