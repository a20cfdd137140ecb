#include <cstddef>

#include "render/passes.hpp"

PLANESCOPE_ASSET_DECLARE(boxes_vert);
PLANESCOPE_ASSET_DECLARE(boxes_frag);
PLANESCOPE_ASSET_DECLARE(id_frag);

namespace planescope::render {
namespace {

struct BoxInstance {
  Vec3f min, max;
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
  set_attribute({0, 3, GL_FLOAT, stride, offsetof(BoxInstance, min), true});
  set_attribute({1, 3, GL_FLOAT, stride, offsetof(BoxInstance, max), true});
  set_attribute({2, 4, GL_UNSIGNED_BYTE, stride, offsetof(BoxInstance, color), true});
  set_attribute({3, 1, GL_FLOAT, stride, offsetof(BoxInstance, hatched), true});
  set_attribute({4, 1, GL_UNSIGNED_INT, stride, offsetof(BoxInstance, id), true});
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
    instances.push_back({box.min, box.max, box.color, hatched, box.id});
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
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size() * sizeof(BoxInstance)),
               instances.data(), GL_STREAM_DRAW);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glDrawArraysInstanced(GL_TRIANGLES, 0, 36, static_cast<GLsizei>(instances.size()));
  glDisable(GL_CULL_FACE);
}

}  // namespace planescope::render
