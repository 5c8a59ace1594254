// Bodies that stand for cells and probes, in world space, coloured on the CPU.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 colour;
layout(location = 0) out vec4 tone;
uniform mat4 view_proj;

void main() {
  tone = colour;
  gl_Position = view_proj * vec4(position, 1);
}
