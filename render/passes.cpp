// Implements the passes (gl.hpp).

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/model/error.hpp"
#include "render/gl.hpp"

PLANESCOPE_ASSET_DECLARE(boxes_frag);
PLANESCOPE_ASSET_DECLARE(boxes_vert);
PLANESCOPE_ASSET_DECLARE(glyphs_frag);
PLANESCOPE_ASSET_DECLARE(glyphs_vert);
PLANESCOPE_ASSET_DECLARE(id_frag);
PLANESCOPE_ASSET_DECLARE(points_frag);
PLANESCOPE_ASSET_DECLARE(points_id_frag);
PLANESCOPE_ASSET_DECLARE(points_vert);
PLANESCOPE_ASSET_DECLARE(polygons_frag);
PLANESCOPE_ASSET_DECLARE(polygons_vert);
PLANESCOPE_ASSET_DECLARE(segments_frag);
PLANESCOPE_ASSET_DECLARE(segments_id_frag);
PLANESCOPE_ASSET_DECLARE(segments_vert);
PLANESCOPE_ASSET_DECLARE(shapes_frag);
PLANESCOPE_ASSET_DECLARE(shapes_vert);

namespace planescope::render {
namespace {

/// Describes one attribute of the bound array buffer. `stride` 0: tightly packed values.
void set_attribute(GLuint location,
                   GLint components,
                   GLenum type,  // GL_UNSIGNED_BYTE: normalized to 0..1; GL_UNSIGNED_INT:
                                 // stays integer
                   std::size_t stride = 0,
                   std::size_t offset = 0,
                   bool per_instance = false) {
  // An offset into the bound buffer; OpenGL takes it as a pointer.
  const void* at = reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
  const auto step = static_cast<GLsizei>(stride);
  glEnableVertexAttribArray(location);
  if (type == GL_UNSIGNED_INT)
    glVertexAttribIPointer(location, components, type, step, at);
  else
    glVertexAttribPointer(location, components, type, type == GL_UNSIGNED_BYTE, step, at);
  glVertexAttribDivisor(location, per_instance ? 1 : 0);
}

/// Fills an array buffer and leaves it bound.
template <typename Value>
void upload(const GlBuffer& buffer, const std::vector<Value>& values) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(Value)),
               values.data(), GL_STREAM_DRAW);
}

}  // namespace

Pass::Pass(const char* name,
           std::string_view vertex,
           std::string_view fragment,
           std::string_view id)
    : color_(make_program(name, vertex, fragment)),
      id_(id.empty() ? GlProgram() : make_program(name, vertex, id)) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
}

const GlProgram& Pass::use(const View& view, Output output) const {
  const GlProgram& program = output == Output::color ? color_ : id_;
  glUseProgram(program);
  set_uniform(program, "view", view.view);  // GL ignores uniforms that a program lacks
  set_uniform(program, "proj", view.proj);
  set_uniform(program, "viewport", view.size_px());
  set_uniform(program, "orthographic", view.orthographic);
  set_uniform(program, "near_m", view.near_m);
  set_uniform(program, "px_per_m", view.px_per_m);
  glBindVertexArray(array_);
  return program;
}

template <typename Values>
void Pass::draw_strips(const Values& instances) const {
  upload(buffer_, instances);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(instances.size()));
}

// ---- Points ----

PointPass::PointPass()
    : Pass("points",
           PLANESCOPE_ASSET(points_vert),
           PLANESCOPE_ASSET(points_frag),
           PLANESCOPE_ASSET(points_id_frag)) {
  static_assert(sizeof(Vec3f) == 12 && sizeof(Rgba) == 4);
  set_attribute(0, 3, GL_FLOAT);
  glBindBuffer(GL_ARRAY_BUFFER, colors_);
  set_attribute(1, 4, GL_UNSIGNED_BYTE);
  glBindBuffer(GL_ARRAY_BUFFER, ids_);
  set_attribute(2, 1, GL_UNSIGNED_INT);
}

void PointPass::draw(const std::vector<DrawPoints>& clouds, const View& view, Output output) {
  const GlProgram& program = use(view, output);
  glEnable(GL_PROGRAM_POINT_SIZE);
  for (const DrawPoints& cloud : clouds) {
    assert(cloud.colors.size() == cloud.positions.size());
    assert(cloud.ids.empty() || cloud.ids.size() == cloud.positions.size());
    if (cloud.positions.empty()) continue;
    set_uniform(program, "size_m", cloud.size_m);
    set_uniform(program, "min_px", std::max(cloud.min_px, 1.0f));
    set_uniform(program, "max_px", std::max({cloud.max_px, cloud.min_px, 1.0f}));
    upload(buffer_, cloud.positions);
    upload(colors_, cloud.colors);
    if (output == Output::id && !cloud.ids.empty()) {
      upload(ids_, cloud.ids);
      glEnableVertexAttribArray(2);
    } else {  // not pickable, but occludes objects behind it
      glDisableVertexAttribArray(2);
      glVertexAttribI1ui(2, 0);
    }
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(cloud.positions.size()));
  }
  glDisable(GL_PROGRAM_POINT_SIZE);
}

// ---- Boxes ----

namespace {

struct BoxInstance {
  std::array<Vec3f, 8> corners;
  Rgba color;
  float hatched = 0;
  std::uint32_t id = 0;
};

}  // namespace

BoxPass::BoxPass()
    : Pass("boxes",
           PLANESCOPE_ASSET(boxes_vert),
           PLANESCOPE_ASSET(boxes_frag),
           PLANESCOPE_ASSET(id_frag)) {
  const std::size_t stride = sizeof(BoxInstance);
  for (GLuint i = 0; i < 8; ++i)
    set_attribute(i, 3, GL_FLOAT, stride, i * sizeof(Vec3f), true);  // corners
  set_attribute(8, 4, GL_UNSIGNED_BYTE, stride, offsetof(BoxInstance, color), true);
  set_attribute(9, 1, GL_FLOAT, stride, offsetof(BoxInstance, hatched), true);
  set_attribute(10, 1, GL_UNSIGNED_INT, stride, offsetof(BoxInstance, id), true);
}

void BoxPass::draw(const std::vector<DrawBox>& boxes,
                   const View& view,
                   float face_alpha,
                   float hatch_period_px,
                   Output output) {
  std::vector<BoxInstance> instances;
  instances.reserve(boxes.size());
  for (const DrawBox& box : boxes) {
    if (box.style == BoxStyle::outline) continue;
    if (output == Output::id && box.id == 0) continue;
    const float hatched = box.style == BoxStyle::hatched ? 1.0f : 0.0f;
    instances.push_back({box.corners, box.color, hatched, box.id});
  }
  if (instances.empty()) return;

  const GlProgram& program = use(view, output);
  set_uniform(program, "face_alpha", face_alpha);
  set_uniform(program, "hatch_period_px", hatch_period_px);
  upload(buffer_, instances);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glDrawArraysInstanced(GL_TRIANGLES, 0, 36, static_cast<GLsizei>(instances.size()));
  glDisable(GL_CULL_FACE);
}

// ---- Segments ----

SegmentPass::SegmentPass()
    : Pass("segments",
           PLANESCOPE_ASSET(segments_vert),
           PLANESCOPE_ASSET(segments_frag),
           PLANESCOPE_ASSET(segments_id_frag)) {
  const std::size_t stride = sizeof(Segment);
  set_attribute(0, 3, GL_FLOAT, stride, offsetof(Segment, a), true);
  set_attribute(1, 3, GL_FLOAT, stride, offsetof(Segment, b), true);
  set_attribute(2, 4, GL_UNSIGNED_BYTE, stride, offsetof(Segment, color), true);
  static_assert(offsetof(Segment, bias_m) == offsetof(Segment, width_px) + 8);
  set_attribute(3, 3, GL_FLOAT, stride, offsetof(Segment, width_px), true);
  set_attribute(4, 1, GL_UNSIGNED_INT, stride, offsetof(Segment, id), true);
}

void SegmentPass::draw(const std::vector<Segment>& segments,
                       const View& view,
                       Rgba halo,
                       Output output) {
  if (segments.empty()) return;
  set_uniform(use(view, output), "halo", halo);
  draw_strips(segments);
}

void SegmentPass::draw_flat(const std::vector<Segment>& segments, int width, int height) {
  View flat;
  flat.width = width;
  flat.height = height;
  flat.orthographic = true;
  flat.near_m = -1e9f;  // disable clipping
  flat.view.setIdentity();
  flat.proj.setIdentity();
  flat.proj(0, 0) = 2.0f / static_cast<float>(width);
  flat.proj(1, 1) = -2.0f / static_cast<float>(height);
  flat.proj(0, 3) = -1;
  flat.proj(1, 3) = 1;
  draw(segments, flat, {0, 0, 0, 0}, Output::color);
}

void append_edges(const DrawBox& box, const View& view, std::vector<Segment>& segments) {
  float edge_m = 0;  // longest edge
  each_edge(box, [&](const Vec3f& from, const Vec3f& to) {
    edge_m = std::max(edge_m, (to - from).norm());
  });
  // Small boxes on screen get thinner edges, so that their color remains visible.
  float width_px = 1.4f;
  if (const auto middle = project(view, middle_of(box))) {
    const double scale = view.orthographic ? view.px_per_m : view.px_per_m / middle->depth_m;
    width_px = static_cast<float>(std::clamp(0.08 * edge_m * scale, 0.5, 1.4));
  }
  const float bias_m = 0.02f * edge_m + 0.0005f;
  each_edge(box, [&](const Vec3f& from, const Vec3f& to) {
    segments.push_back({from, to, box.color, width_px, 0, bias_m, box.id});
  });
}

void append_outline(const DrawPolygon& polygon, float bias_m, std::vector<Segment>& segments) {
  if (!polygon.triangles.empty()) return;
  const std::size_t n = polygon.corners.size();
  for (std::size_t i = 0; i < n && n >= 2; ++i)
    segments.push_back({polygon.corners[i], polygon.corners[(i + 1) % n], polygon.outline,
                        polygon.outline_px, 0, bias_m, polygon.id});
}

// ---- Polygons ----

namespace {

struct Vertex {
  Vec3f position;
  Rgba color;
  std::uint32_t id = 0;
};

}  // namespace

PolygonPass::PolygonPass()
    : Pass("polygons",
           PLANESCOPE_ASSET(polygons_vert),
           PLANESCOPE_ASSET(polygons_frag),
           PLANESCOPE_ASSET(id_frag)) {
  const std::size_t stride = sizeof(Vertex);
  set_attribute(0, 3, GL_FLOAT, stride, offsetof(Vertex, position), false);
  set_attribute(1, 4, GL_UNSIGNED_BYTE, stride, offsetof(Vertex, color), false);
  set_attribute(2, 1, GL_UNSIGNED_INT, stride, offsetof(Vertex, id), false);
}

void PolygonPass::draw(const std::vector<const DrawPolygon*>& polygons,
                       const View& view,
                       float bias_m,
                       Output output) {
  std::vector<Vertex> vertices;
  for (const DrawPolygon* polygon : polygons) {
    if (output == Output::id && polygon->id == 0) continue;
    const std::vector<Vec3f>& corners = polygon->corners;
    for (const std::uint32_t k : polygon->triangles)
      vertices.push_back({corners[k], polygon->fill, polygon->id});
    if (!polygon->triangles.empty()) continue;
    for (std::size_t i = 2; i < corners.size(); ++i)  // convex: draw as a fan
      for (const std::size_t k : {std::size_t{0}, i - 1, i})
        vertices.push_back({corners[k], polygon->fill, polygon->id});
  }
  if (vertices.empty()) return;

  set_uniform(use(view, output), "bias_m", bias_m);
  upload(buffer_, vertices);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
}

// ---- Shapes ----

ShapePass::ShapePass()
    : Pass("shapes", PLANESCOPE_ASSET(shapes_vert), PLANESCOPE_ASSET(shapes_frag), {}) {
  const std::size_t stride = sizeof(OverlayShape);
  static_assert(offsetof(OverlayShape, hatch_period_px) == offsetof(OverlayShape, radius) + 8);
  set_attribute(0, 4, GL_FLOAT, stride, offsetof(OverlayShape, x0), true);
  set_attribute(1, 4, GL_UNSIGNED_BYTE, stride, offsetof(OverlayShape, fill), true);
  set_attribute(2, 4, GL_UNSIGNED_BYTE, stride, offsetof(OverlayShape, border), true);
  set_attribute(3, 3, GL_FLOAT, stride, offsetof(OverlayShape, radius), true);
}

void ShapePass::draw(const std::vector<OverlayShape>& shapes, const View& view) {
  if (shapes.empty()) return;
  use(view, Output::color);
  draw_strips(shapes);
}

// ---- Text ----

TextPass::TextPass()
    : Pass("glyphs", PLANESCOPE_ASSET(glyphs_vert), PLANESCOPE_ASSET(glyphs_frag), {}) {
  const std::size_t stride = sizeof(Instance);
  set_attribute(0, 4, GL_FLOAT, stride, offsetof(Instance, x), true);
  set_attribute(1, 2, GL_FLOAT, stride, offsetof(Instance, atlas_x), true);
  set_attribute(2, 4, GL_UNSIGNED_BYTE, stride, offsetof(Instance, color), true);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  clear_atlas(512);
}

void TextPass::draw(const std::vector<OverlayText>& texts, const View& view) {
  // If the atlas is full, start over with an empty one; if the texts still do not fit, enlarge it.
  std::vector<Instance> instances;
  for (int attempt = 0;; ++attempt) {
    instances.clear();
    const auto fits = [&](const OverlayText& text) { return append(text, instances); };
    if (std::all_of(texts.begin(), texts.end(), fits)) break;
    clear_atlas(attempt == 0 ? atlas_height_ : atlas_height_ * 2);
  }
  if (instances.empty()) return;
  set_uniform(use(view, Output::color), "atlas", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  if (std::exchange(atlas_changed_, false)) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, kAtlasWidth, atlas_height_, 0, GL_RED, GL_UNSIGNED_BYTE,
                 atlas_.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  }
  draw_strips(instances);
}

// Returns false if the atlas is full.
bool TextPass::append(const OverlayText& text, std::vector<Instance>& instances) {
  constexpr double kMaxSize_px = 256;
  const auto sixteenths = [](double value) { return static_cast<int>(std::lround(value * 16)); };
  const double size_px = std::clamp(text.size_px, 1.0, kMaxSize_px);
  const TextLayout layout = layout_text(text.text, size_px);
  const double baseline = std::round(text.baseline);
  for (const bool halo : {true, false}) {
    if (halo && (text.halo_px <= 0 || text.halo.a == 0)) continue;
    for (const PlacedGlyph& placed : layout.glyphs) {
      const GlyphPen pen = pen_at(text.x + placed.x);
      const Entry* glyph = entry(
          {placed.codepoint, sixteenths(size_px), pen.phase, halo ? sixteenths(text.halo_px) : 0});
      if (glyph == nullptr) return false;
      if (glyph->width == 0) continue;
      instances.push_back({static_cast<float>(pen.column + glyph->left),
                           static_cast<float>(baseline + glyph->top),
                           static_cast<float>(glyph->width), static_cast<float>(glyph->height),
                           static_cast<float>(glyph->x), static_cast<float>(glyph->y),
                           halo ? text.halo : text.color});
    }
  }
  return true;
}

const TextPass::Entry* TextPass::entry(const Key& key) {
  if (const auto found = entries_.find(key); found != entries_.end()) return &found->second;
  GlyphBitmap glyph = glyph_bitmap(key.codepoint, key.size_q / 16.0, key.phase);
  if (key.halo_q > 0 && glyph.width > 0) glyph = grown(glyph, key.halo_q / 16.0);
  if (shelf_x_ + glyph.width > kAtlasWidth) {
    shelf_y_ += shelf_height_ + 1;
    shelf_x_ = 0;
    shelf_height_ = 0;
  }
  if (glyph.width > kAtlasWidth || shelf_y_ + glyph.height > atlas_height_) return nullptr;
  for (int y = 0; y < glyph.height; ++y)
    std::copy_n(glyph.coverage.begin() + y * glyph.width, glyph.width,
                atlas_.begin() + (shelf_y_ + y) * kAtlasWidth + shelf_x_);
  atlas_changed_ = true;
  const Entry entry = {shelf_x_, shelf_y_, glyph.width, glyph.height, glyph.left, glyph.top};
  shelf_x_ += glyph.width + 1;
  shelf_height_ = std::max(shelf_height_, glyph.height);
  return &entries_.emplace(key, entry).first->second;
}

void TextPass::clear_atlas(int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (height > largest) throw Error("too many different glyphs in the picture for one texture");
  atlas_height_ = height;
  atlas_.assign(static_cast<std::size_t>(kAtlasWidth) * height, 0);
  entries_.clear();
  shelf_x_ = shelf_y_ = shelf_height_ = 0;
  atlas_changed_ = true;
}

}  // namespace planescope::render
