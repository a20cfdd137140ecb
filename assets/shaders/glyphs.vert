#version 330 core
// One instance per glyph; pixel of the picture = pixel of the atlas.
layout(location = 0) in vec4 rect;  // x, y of the top left corner, width, height [px]
layout(location = 1) in vec2 atlas_at;
layout(location = 2) in vec4 color;
uniform vec2 viewport;
flat out vec4 v_color;
out vec2 v_texel;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1);
  v_color = color;
  v_texel = atlas_at + corner * rect.zw;
  vec2 ndc = (rect.xy + corner * rect.zw) / viewport * 2.0 - 1.0;
  gl_Position = vec4(ndc.x, -ndc.y, 0.0, 1.0);
}
