#version 330 core
uniform sampler2D atlas;
flat in vec4 v_color;
in vec2 v_texel;
out vec4 color;
void main() {
  color = vec4(v_color.rgb, v_color.a * texelFetch(atlas, ivec2(v_texel), 0).r);
}
