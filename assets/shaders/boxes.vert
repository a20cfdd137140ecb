#version 330 core
// Faces of axis-aligned boxes, one instance each: 36 vertices, counter-clockwise seen from outside.
layout(location = 0) in vec3 box_min;
layout(location = 1) in vec3 box_max;
layout(location = 2) in vec4 color;
layout(location = 3) in float hatched;
layout(location = 4) in uint id;
uniform mat4 view;
uniform mat4 proj;
flat out vec4 v_color;
flat out float v_hatched;
flat out float v_light;
flat out uint v_id;

// Bit 0 of a corner: x, bit 1: y, bit 2: z.
const int kCorners[36] = int[36](0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2,
                                 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6);
const float kLight[6] = float[6](0.86, 0.86, 0.94, 0.94, 0.80, 1.0);

void main() {
  int corner = kCorners[gl_VertexID];
  vec3 upper = vec3(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
  v_color = color;
  v_hatched = hatched;
  v_light = kLight[gl_VertexID / 6];
  v_id = id;
  gl_Position = proj * view * vec4(mix(box_min, box_max, upper), 1.0);
}
