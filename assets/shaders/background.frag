#version 330 core
uniform vec4 top;
uniform vec4 bottom;
uniform vec2 viewport;  // [px]
out vec4 color;
void main() { color = mix(bottom, top, gl_FragCoord.y / viewport.y); }
