#include <cstddef>

#include "render/passes.hpp"

PLANESCOPE_ASSET_DECLARE(polygons_vert);
PLANESCOPE_ASSET_DECLARE(polygons_frag);
PLANESCOPE_ASSET_DECLARE(id_frag);

namespace planescope::render {
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
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
               vertices.data(), GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
}

}  // namespace planescope::render
