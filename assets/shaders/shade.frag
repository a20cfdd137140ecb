#version 330 core
// Eye-dome lighting (Boucheny 2009): a point is darkened by how far its neighbours on screen stand
// before it, up to a bound: what is seen through the gaps of a nearer surface stays legible. Edges
// and creases of a cloud show without normals. Multiplied onto the picture.
uniform sampler2D depth;
uniform mat4 proj;
uniform bool orthographic;
uniform float radius_px;
uniform float strength;
out vec4 color;

const vec2 kRing[8] = vec2[8](vec2(1, 0), vec2(0.7071, 0.7071), vec2(0, 1), vec2(-0.7071, 0.7071),
                              vec2(-1, 0), vec2(-0.7071, -0.7071), vec2(0, -1),
                              vec2(0.7071, -0.7071));

// log2 of the distance, so that a step counts in proportion to where it is.
float log_distance(float d) {
  float ndc = 2.0 * d - 1.0;
  float z = orthographic ? (ndc - proj[3][2]) / -proj[2][2] : proj[3][2] / (ndc + proj[2][2]);
  return log2(max(abs(z), 1e-6));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float d = texelFetch(depth, at, 0).r;
  if (d >= 1.0) discard;
  ivec2 last = textureSize(depth, 0) - 1;
  float here = log_distance(d);
  float before = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec2 there = clamp(at + ivec2(round(kRing[i] * radius_px)), ivec2(0), last);
    float dn = texelFetch(depth, there, 0).r;
    if (dn < 1.0) before += min(max(0.0, here - log_distance(dn)), 0.015);
  }
  color = vec4(vec3(max(exp(-strength * before / 8.0), 0.3)), 1.0);
}
