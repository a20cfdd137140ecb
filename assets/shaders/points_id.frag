#version 330 core
uniform mat4 proj;
uniform bool orthographic;
flat in uint v_id;
flat in float v_radius_px;
flat in float v_radius_m;
flat in float v_eye_z;
out uint id;
void main() {
  float r_px = length(gl_PointCoord - 0.5) * (2.0 * v_radius_px + 1.0);
  if (r_px > max(v_radius_px, 0.71)) discard;  // at least the pixel it stands on
  float r = min(r_px / v_radius_px, 1.0);
  id = v_id;
  float z = v_eye_z + v_radius_m * (1.0 - r * r);
  float ndc = proj[2][2] * z + proj[3][2];
  if (!orthographic) ndc /= max(-z, 1e-6);
  gl_FragDepth = clamp(0.5 * ndc + 0.5, 0.0, 1.0);
}
