#include "render/shapes.hpp"

#include <cstddef>

PLANESCOPE_ASSET_DECLARE(shapes_vert);
PLANESCOPE_ASSET_DECLARE(shapes_frag);

namespace planescope::render {

ShapePass::ShapePass()
    : program_(
          make_program("shapes", PLANESCOPE_ASSET(shapes_vert), PLANESCOPE_ASSET(shapes_frag))),
      array_(make_vertex_array()),
      instances_(make_buffer()) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  const std::size_t stride = sizeof(OverlayShape);
  static_assert(offsetof(OverlayShape, hatch_period_px) == offsetof(OverlayShape, radius) + 8);
  set_attribute({0, 4, GL_FLOAT, stride, offsetof(OverlayShape, x0), true});
  set_attribute({1, 4, GL_UNSIGNED_BYTE, stride, offsetof(OverlayShape, fill), true});
  set_attribute({2, 4, GL_UNSIGNED_BYTE, stride, offsetof(OverlayShape, border), true});
  set_attribute({3, 3, GL_FLOAT, stride, offsetof(OverlayShape, radius), true});
}

void ShapePass::draw(std::span<const OverlayShape> shapes, int width, int height) {
  if (shapes.empty()) return;
  glUseProgram(program_);
  set_uniform(program_, "viewport",
              Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height)));
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(shapes.size_bytes()), shapes.data(),
               GL_STREAM_DRAW);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(shapes.size()));
}

}  // namespace planescope::render
