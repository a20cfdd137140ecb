#include <algorithm>
#include <cstddef>

#include "render/passes.hpp"

PLANESCOPE_ASSET_DECLARE(segments_vert);
PLANESCOPE_ASSET_DECLARE(segments_frag);
PLANESCOPE_ASSET_DECLARE(segments_id_frag);

namespace planescope::render {
namespace {

void upload_and_draw(const GlVertexArray& array,
                     const GlBuffer& buffer,
                     std::span<const Segment> segments) {
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(segments.size_bytes()), segments.data(),
               GL_STREAM_DRAW);
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
  const float edge_m = (box.max - box.min).maxCoeff();
  // Small boxes on screen get finer edges, so that their colour is still seen between them.
  float width_px = 1.4f;
  if (const auto middle = project(view, 0.5f * (box.min + box.max))) {
    const double scale = view.orthographic ? view.px_per_m : view.px_per_m / middle->depth_m;
    width_px = static_cast<float>(std::clamp(0.08 * edge_m * scale, 0.5, 1.4));
  }
  const float bias_m = 0.02f * edge_m + 0.0005f;
  each_edge(box, [&](const Vec3f& from, const Vec3f& to) {
    segments.push_back({from, to, box.color, width_px, 0, bias_m, box.id});
  });
}

void append_outline(const DrawPolygon& polygon, float bias_m, std::vector<Segment>& segments) {
  const std::size_t n = polygon.corners.size();
  for (std::size_t i = 0; i < n && n >= 2; ++i) {
    segments.push_back({polygon.corners[i], polygon.corners[(i + 1) % n], polygon.outline,
                        polygon.outline_px, 0, bias_m, polygon.id});
  }
}

}  // namespace planescope::render
