#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
layout(location = 2) in uint id;
uniform mat4 view;
uniform mat4 proj;
uniform bool orthographic;
uniform float near_m;
uniform float bias_m;  // drawn this much nearer, to lie over the points of the surface
flat out vec4 v_color;
flat out uint v_id;
void main() {
  vec3 eye = (view * vec4(position, 1.0)).xyz;
  if (orthographic) {
    eye.z += bias_m;
  } else if (-eye.z > 2.0 * near_m) {
    eye *= max(1.0 - bias_m / -eye.z, max(0.5, near_m / -eye.z));  // the same place on screen
  }
  v_color = color;
  v_id = id;
  gl_Position = proj * vec4(eye, 1.0);
}
