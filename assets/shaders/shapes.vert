#version 330 core
// Rounded rectangles of the overlay, in pixels from the top left corner.
layout(location = 0) in vec4 rect;  // x0, y0, x1, y1
layout(location = 1) in vec4 fill;
layout(location = 2) in vec4 border;
layout(location = 3) in vec3 style;  // corner radius, border width, period of the hatching or 0
uniform vec2 viewport;
flat out vec4 v_rect;
flat out vec4 v_fill;
flat out vec4 v_border;
flat out vec3 v_style;
out vec2 v_at;
void main() {
  v_rect = rect;
  v_fill = fill;
  v_border = border;
  v_style = style;
  v_at = vec2((gl_VertexID & 1) == 0 ? rect.x - 1.0 : rect.z + 1.0,
              (gl_VertexID & 2) == 0 ? rect.y - 1.0 : rect.w + 1.0);
  vec2 ndc = v_at / viewport * 2.0 - 1.0;
  gl_Position = vec4(ndc.x, -ndc.y, 0.0, 1.0);
}
