#include <algorithm>
#include <cassert>

#include "render/passes.hpp"

PLANESCOPE_ASSET_DECLARE(points_vert);
PLANESCOPE_ASSET_DECLARE(points_frag);
PLANESCOPE_ASSET_DECLARE(points_id_frag);

namespace planescope::render {
namespace {

template <typename T>
void upload(const GlBuffer& buffer, const std::vector<T>& values) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(),
               GL_STREAM_DRAW);
}

}  // namespace

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

}  // namespace planescope::render
