#version 330 core
// A point is a round splat that bulges towards the eye, so that neighbours on a surface meet in
// even seams instead of covering one another by chance.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
layout(location = 2) in uint id;
uniform mat4 view;
uniform mat4 proj;
uniform bool orthographic;
uniform float px_per_m;
uniform float size_m;
uniform float min_px;
uniform float max_px;
flat out vec4 v_color;
flat out uint v_id;
flat out float v_radius_px;
flat out float v_radius_m;
flat out float v_eye_z;
void main() {
  vec4 eye = view * vec4(position, 1.0);
  float scale = orthographic ? px_per_m : px_per_m / max(-eye.z, 1e-6);
  float size_px = clamp(size_m * scale, min_px, max_px);
  v_color = color;
  v_id = id;
  v_radius_px = 0.5 * size_px;
  v_radius_m = v_radius_px / scale;
  v_eye_z = eye.z;
  gl_Position = proj * eye;
  gl_PointSize = size_px + 1.0;  // room for the soft edge
}
