#include "render/passes.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>

PLANESCOPE_ASSET_DECLARE(boxes_frag);
PLANESCOPE_ASSET_DECLARE(boxes_vert);
PLANESCOPE_ASSET_DECLARE(id_frag);
PLANESCOPE_ASSET_DECLARE(points_frag);
PLANESCOPE_ASSET_DECLARE(points_id_frag);
PLANESCOPE_ASSET_DECLARE(points_vert);
PLANESCOPE_ASSET_DECLARE(polygons_frag);
PLANESCOPE_ASSET_DECLARE(polygons_vert);
PLANESCOPE_ASSET_DECLARE(segments_frag);
PLANESCOPE_ASSET_DECLARE(segments_id_frag);
PLANESCOPE_ASSET_DECLARE(segments_vert);

namespace planescope::render {

// ---- Points ----

PointPass::PointPass()
    : color_(make_program("points", PLANESCOPE_ASSET(points_vert), PLANESCOPE_ASSET(points_frag))),
      id_(make_program(
          "points_id", PLANESCOPE_ASSET(points_vert), PLANESCOPE_ASSET(points_id_frag))),
      array_(make_vertex_array()),
      positions_(make_buffer()),
      colors_(make_buffer()),
      ids_(make_buffer()) {
  static_assert(sizeof(Vec3f) == 12 && sizeof(Rgba) == 4);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, positions_);
  set_attribute({.location = 0, .components = 3});
  glBindBuffer(GL_ARRAY_BUFFER, colors_);
  set_attribute({.location = 1, .components = 4, .type = GL_UNSIGNED_BYTE});
  glBindBuffer(GL_ARRAY_BUFFER, ids_);
  set_attribute({.location = 2, .components = 1, .type = GL_UNSIGNED_INT});
}

void PointPass::draw(const std::vector<DrawPoints>& clouds, const View& view, Output output) {
  const GlProgram& program = output == Output::color ? color_ : id_;
  glUseProgram(program);
  set_uniform(program, "view", view.view);
  set_uniform(program, "proj", view.proj);
  set_uniform(program, "orthographic", view.orthographic ? 1 : 0);
  set_uniform(program, "px_per_m", view.px_per_m);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(array_);
  for (const DrawPoints& cloud : clouds) {
    assert(cloud.colors.size() == cloud.positions.size());
    assert(cloud.ids.empty() || cloud.ids.size() == cloud.positions.size());
    if (cloud.positions.empty()) continue;
    set_uniform(program, "size_m", cloud.size_m);
    set_uniform(program, "min_px", std::max(cloud.min_px, 1.0f));
    set_uniform(program, "max_px", std::max({cloud.max_px, cloud.min_px, 1.0f}));
    upload(positions_, cloud.positions);
    upload(colors_, cloud.colors);
    if (output == Output::id && !cloud.ids.empty()) {
      upload(ids_, cloud.ids);
      glEnableVertexAttribArray(2);
    } else {  // not pickable, but hides what lies behind
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
    : color_(make_program("boxes", PLANESCOPE_ASSET(boxes_vert), PLANESCOPE_ASSET(boxes_frag))),
      id_(make_program("boxes_id", PLANESCOPE_ASSET(boxes_vert), PLANESCOPE_ASSET(id_frag))),
      array_(make_vertex_array()),
      instances_(make_buffer()) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  const std::size_t stride = sizeof(BoxInstance);
  for (GLuint i = 0; i < 8; ++i)
    set_attribute({i, 3, GL_FLOAT, stride, i * sizeof(Vec3f), true});  // corners
  set_attribute({8, 4, GL_UNSIGNED_BYTE, stride, offsetof(BoxInstance, color), true});
  set_attribute({9, 1, GL_FLOAT, stride, offsetof(BoxInstance, hatched), true});
  set_attribute({10, 1, GL_UNSIGNED_INT, stride, offsetof(BoxInstance, id), true});
}

void BoxPass::draw(std::span<const DrawBox> boxes,
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

  const GlProgram& program = output == Output::color ? color_ : id_;
  glUseProgram(program);
  set_uniform(program, "view", view.view);
  set_uniform(program, "proj", view.proj);
  if (output == Output::color) {
    set_uniform(program, "face_alpha", face_alpha);
    set_uniform(program, "hatch_period_px", hatch_period_px);
  }
  glBindVertexArray(array_);
  upload(instances_, instances);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glDrawArraysInstanced(GL_TRIANGLES, 0, 36, static_cast<GLsizei>(instances.size()));
  glDisable(GL_CULL_FACE);
}

// ---- Segments ----

namespace {

void upload_and_draw(const GlVertexArray& array,
                     const GlBuffer& buffer,
                     std::span<const Segment> segments) {
  glBindVertexArray(array);
  upload(buffer, segments);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(segments.size()));
}

}  // namespace

SegmentPass::SegmentPass()
    : color_(make_program(
          "segments", PLANESCOPE_ASSET(segments_vert), PLANESCOPE_ASSET(segments_frag))),
      id_(make_program(
          "segments_id", PLANESCOPE_ASSET(segments_vert), PLANESCOPE_ASSET(segments_id_frag))),
      array_(make_vertex_array()),
      instances_(make_buffer()) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  const std::size_t stride = sizeof(Segment);
  set_attribute({0, 3, GL_FLOAT, stride, offsetof(Segment, a), true});
  set_attribute({1, 3, GL_FLOAT, stride, offsetof(Segment, b), true});
  set_attribute({2, 4, GL_UNSIGNED_BYTE, stride, offsetof(Segment, color), true});
  static_assert(offsetof(Segment, bias_m) == offsetof(Segment, width_px) + 8);
  set_attribute({3, 3, GL_FLOAT, stride, offsetof(Segment, width_px), true});
  set_attribute({4, 1, GL_UNSIGNED_INT, stride, offsetof(Segment, id), true});
}

void SegmentPass::draw(std::span<const Segment> segments,
                       const View& view,
                       Rgba halo,
                       Output output) {
  if (segments.empty()) return;
  const GlProgram& program = output == Output::color ? color_ : id_;
  glUseProgram(program);
  set_uniform(program, "view", view.view);
  set_uniform(program, "proj", view.proj);
  set_uniform(program, "viewport", view.size_px());
  set_uniform(program, "orthographic", view.orthographic ? 1 : 0);
  set_uniform(program, "near_m", view.near_m);
  if (output == Output::color) set_uniform(program, "halo", to_vector(halo));
  upload_and_draw(array_, instances_, segments);
}

void SegmentPass::draw_flat(std::span<const Segment> segments, int width, int height) {
  View flat;
  flat.width = width;
  flat.height = height;
  flat.orthographic = true;
  flat.near_m = -1e9f;  // nothing is clipped
  flat.view.setIdentity();
  flat.proj.setIdentity();
  flat.proj(0, 0) = 2.0f / static_cast<float>(width);
  flat.proj(1, 1) = -2.0f / static_cast<float>(height);
  flat.proj(0, 3) = -1;
  flat.proj(1, 3) = 1;
  draw(segments, flat, {0, 0, 0, 0}, Output::color);
}

void append_edges(const DrawBox& box, const View& view, std::vector<Segment>& segments) {
  float edge_m = 0;  // the longest
  each_edge(box, [&](const Vec3f& from, const Vec3f& to) {
    edge_m = std::max(edge_m, (to - from).norm());
  });
  // Small boxes on screen get finer edges, so that their colour is still seen between them.
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
  for (std::size_t i = 0; i < n && n >= 2; ++i) {
    segments.push_back({polygon.corners[i], polygon.corners[(i + 1) % n], polygon.outline,
                        polygon.outline_px, 0, bias_m, polygon.id});
  }
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
    : color_(make_program(
          "polygons", PLANESCOPE_ASSET(polygons_vert), PLANESCOPE_ASSET(polygons_frag))),
      id_(make_program("polygons_id", PLANESCOPE_ASSET(polygons_vert), PLANESCOPE_ASSET(id_frag))),
      array_(make_vertex_array()),
      vertices_(make_buffer()) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  const std::size_t stride = sizeof(Vertex);
  set_attribute({0, 3, GL_FLOAT, stride, offsetof(Vertex, position), false});
  set_attribute({1, 4, GL_UNSIGNED_BYTE, stride, offsetof(Vertex, color), false});
  set_attribute({2, 1, GL_UNSIGNED_INT, stride, offsetof(Vertex, id), false});
}

void PolygonPass::draw(std::span<const DrawPolygon* const> polygons,
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
    for (std::size_t i = 2; i < corners.size(); ++i) {  // a fan, as it is convex
      for (const std::size_t k : {std::size_t{0}, i - 1, i}) {
        vertices.push_back({corners[k], polygon->fill, polygon->id});
      }
    }
  }
  if (vertices.empty()) return;

  const GlProgram& program = output == Output::color ? color_ : id_;
  glUseProgram(program);
  set_uniform(program, "view", view.view);
  set_uniform(program, "proj", view.proj);
  set_uniform(program, "orthographic", view.orthographic ? 1 : 0);
  set_uniform(program, "near_m", view.near_m);
  set_uniform(program, "bias_m", bias_m);
  glBindVertexArray(array_);
  upload(vertices_, vertices);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
}

}  // namespace planescope::render
