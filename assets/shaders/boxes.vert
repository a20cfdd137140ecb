#version 330 core
// Faces of boxes, one instance each: 36 vertices, counter-clockwise seen from outside.
layout(location = 0) in vec3 corners[8];
layout(location = 8) in vec4 color;
layout(location = 9) in float hatched;
layout(location = 10) in uint id;
uniform mat4 view;
uniform mat4 proj;
flat out vec4 v_color;
flat out float v_hatched;
flat out float v_light;
flat out uint v_id;

// Bit 0 of a corner: greater along the first axis, bit 1: the second, bit 2: the third.
const int kCorners[36] = int[36](0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2,
                                 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6);
const float kLight[6] = float[6](0.86, 0.86, 0.94, 0.94, 0.80, 1.0);

void main() {
  v_color = color;
  v_hatched = hatched;
  v_light = kLight[gl_VertexID / 6];
  v_id = id;
  gl_Position = proj * view * vec4(corners[kCorners[gl_VertexID]], 1.0);
}
