#version 330 core
uniform float face_alpha;
uniform float hatch_period_px;
flat in vec4 v_color;
flat in float v_hatched;
flat in float v_light;
out vec4 color;
void main() {
  float alpha = face_alpha;
  if (v_hatched > 0.5) {
    // Diagonal stripes fixed on screen, a third of the period wide, with soft edges.
    float phase = fract((gl_FragCoord.x + gl_FragCoord.y) / hatch_period_px);
    float from_middle_px = abs(phase - 0.5) * hatch_period_px * 0.7071;
    float half_width_px = hatch_period_px * 0.7071 / 6.0;
    alpha = mix(0.5 * face_alpha, 0.85, clamp(half_width_px + 0.5 - from_middle_px, 0.0, 1.0));
  }
  color = vec4(v_color.rgb * v_light, v_color.a * alpha);
}
