#version 330 core
uniform vec4 halo;  // around arrows, to set them off from the points
flat in vec4 v_color;
flat in float v_length_px;
flat in float v_width_px;
flat in float v_head_px;
noperspective in vec2 v_at_px;
out vec4 color;

// Signed distance to the shape [px].
float distance_px(vec2 at) {
  float shaft_end = v_length_px - 0.6 * v_head_px;
  float shaft =
      length(vec2(at.x - clamp(at.x, 0.0, shaft_end), at.y)) - 0.5 * v_width_px;
  if (v_head_px <= 0.0) return shaft;
  float half_base = 0.45 * v_head_px;
  vec2 side = normalize(vec2(half_base, v_head_px));  // outward normal of the slanted side
  float slanted = dot(vec2(at.x - v_length_px, abs(at.y)), side);
  return min(shaft, max(slanted, v_length_px - v_head_px - at.x));
}

void main() {
  float d = distance_px(v_at_px);
  float coverage = clamp(0.5 - d, 0.0, 1.0);
  float around = v_head_px > 0.0 ? halo.a * clamp(0.5 - (d - 1.25), 0.0, 1.0) : 0.0;
  float alpha = max(coverage, around);
  if (alpha <= 0.0) discard;
  color = vec4(mix(halo.rgb, v_color.rgb, v_head_px > 0.0 ? coverage : 1.0), alpha * v_color.a);
}
