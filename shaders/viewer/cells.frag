layout(location = 0) in vec4 tone;
layout(location = 0) out vec4 colour;

void main() { colour = tone; }
