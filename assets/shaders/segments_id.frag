#version 330 core
flat in uint v_id;
flat in float v_length_px;
flat in float v_width_px;
noperspective in vec2 v_at_px;
out uint id;
void main() {
  float off = length(vec2(v_at_px.x - clamp(v_at_px.x, 0.0, v_length_px), v_at_px.y));
  if (off > 0.5 * v_width_px) discard;
  id = v_id;
}
