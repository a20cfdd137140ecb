#version 330 core
uniform mat4 proj;
uniform bool orthographic;
flat in vec4 v_color;
flat in float v_radius_px;
flat in float v_radius_m;
flat in float v_eye_z;
out vec4 color;
void main() {
  float r_px = length(gl_PointCoord - 0.5) * (2.0 * v_radius_px + 1.0);
  float coverage = clamp(v_radius_px + 0.5 - r_px, 0.0, 1.0);
  if (coverage <= 0.0) discard;
  float r = min(r_px / v_radius_px, 1.0);
  // A slightly darker rim, on splats large enough to show one.
  float rim = smoothstep(0.55, 1.0, r) * smoothstep(1.5, 4.0, v_radius_px);
  color = vec4(v_color.rgb * (1.0 - 0.14 * rim), v_color.a * coverage);
  float z = v_eye_z + v_radius_m * (1.0 - r * r);
  float ndc = proj[2][2] * z + proj[3][2];
  if (!orthographic) ndc /= max(-z, 1e-6);
  gl_FragDepth = clamp(0.5 * ndc + 0.5, 0.0, 1.0);
}
