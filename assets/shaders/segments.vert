#version 330 core
// A line or an arrow as a rectangle on screen, wide enough for its caps and its head: the core
// profile has no wide lines.
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
layout(location = 2) in vec4 color;
layout(location = 3) in vec3 style;  // width [px], 1 for an arrow, bias towards the eye [m]
layout(location = 4) in uint id;
uniform mat4 view;
uniform mat4 proj;
uniform vec2 viewport;  // [px]
uniform bool orthographic;
uniform float near_m;
flat out vec4 v_color;
flat out uint v_id;
flat out float v_length_px;
flat out float v_width_px;
flat out float v_head_px;  // 0: no head
noperspective out vec2 v_at_px;  // along the segment from a, and across

vec3 nearer(vec3 eye, float bias_m) {
  if (orthographic) return eye + vec3(0.0, 0.0, bias_m);
  return eye * max(1.0 - bias_m / -eye.z, max(0.5, near_m / -eye.z));
}

void main() {
  vec3 ea = (view * vec4(a, 1.0)).xyz;
  vec3 eb = (view * vec4(b, 1.0)).xyz;
  v_color = color;
  v_id = id;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // nowhere, unless the segment is seen
  if (ea.z > -near_m && eb.z > -near_m) return;
  if (ea.z > -near_m) ea = mix(ea, eb, (ea.z + near_m) / (ea.z - eb.z));
  if (eb.z > -near_m) eb = mix(eb, ea, (eb.z + near_m) / (eb.z - ea.z));
  vec4 ca = proj * vec4(nearer(ea, style.z), 1.0);
  vec4 cb = proj * vec4(nearer(eb, style.z), 1.0);
  vec3 na = ca.xyz / ca.w;
  vec3 nb = cb.xyz / cb.w;
  vec2 pa = (0.5 * na.xy + 0.5) * viewport;
  vec2 pb = (0.5 * nb.xy + 0.5) * viewport;
  float len = length(pb - pa);
  vec2 along = len > 1e-4 ? (pb - pa) / len : vec2(1.0, 0.0);

  // Thinner than a pixel is drawn as a paler pixel.
  v_width_px = max(style.x, 1.0);
  v_color.a *= min(style.x, 1.0);
  v_length_px = len;
  v_head_px = style.y > 0.5 ? min(max(4.0 * v_width_px, 8.0), 0.7 * len) : 0.0;
  // Room for the soft edge, and for an arrow's halo.
  float reach = v_head_px > 0.0 ? max(0.5 * v_width_px, 0.45 * v_head_px) + 3.0
                                : 0.5 * v_width_px + 1.0;
  v_at_px.x = (gl_VertexID & 1) == 0 ? -reach : len + reach;
  v_at_px.y = (gl_VertexID & 2) == 0 ? -reach : reach;
  vec2 at = pa + along * v_at_px.x + vec2(-along.y, along.x) * v_at_px.y;
  float z = mix(na.z, nb.z, clamp(v_at_px.x / max(len, 1e-4), 0.0, 1.0));
  gl_Position = vec4(at / viewport * 2.0 - 1.0, z, 1.0);
}
