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

// Proportional to 1 / distance, so that a step counts in proportion to where it is.
float nearness(float d) {
  float ndc = 2.0 * d - 1.0;
  if (orthographic) return 1.0 / max(abs((ndc - proj[3][2]) / proj[2][2]), 1e-6);
  return abs(ndc + proj[2][2]);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float d = texelFetch(depth, at, 0).r;
  if (d >= 1.0) discard;
  ivec2 last = textureSize(depth, 0) - 1;
  float here = 1.0 / max(nearness(d), 1e-9);
  float before = 0.0;  // sum of log2 of the ratios of distances, each up to 0.015
  for (int i = 0; i < 8; ++i) {
    ivec2 there = clamp(at + ivec2(round(kRing[i] * radius_px)), ivec2(0), last);
    float dn = texelFetch(depth, there, 0).r;
    float farther = clamp(nearness(dn) * here - 1.0, 0.0, 0.0106);
    if (dn < 1.0) before += min(farther * (1.442695 - 0.721348 * farther), 0.015);
  }
  color = vec4(vec3(max(exp(-strength * before / 8.0), 0.3)), 1.0);
}
