#version 330 core
flat in vec4 v_rect;
flat in vec4 v_fill;
flat in vec4 v_border;
flat in vec3 v_style;
in vec2 v_at;
out vec4 color;
void main() {
  vec2 half_size = 0.5 * (v_rect.zw - v_rect.xy);
  vec2 q = abs(v_at - 0.5 * (v_rect.xy + v_rect.zw)) - half_size + v_style.x;
  float d = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0) - v_style.x;
  vec4 fill = v_fill;
  if (v_style.z > 0.0) {
    float period = v_style.z;
    float phase = fract((v_at.x - v_rect.x - v_at.y + v_rect.y) / period);
    float from_middle = abs(phase - 0.5) * period * 0.7071;
    fill.a *= mix(0.2, 1.0, clamp(period * 0.7071 / 6.0 + 0.5 - from_middle, 0.0, 1.0));
  }
  float inner = v_style.y > 0.0 ? clamp(0.5 - (d + v_style.y), 0.0, 1.0) : 1.0;
  vec4 mixed = mix(v_border, fill, inner);
  color = vec4(mixed.rgb, mixed.a * clamp(0.5 - d, 0.0, 1.0));
}
