layout(points) in;
layout(points, max_vertices = 1) out;

flat in int layer[];
flat in vec3 normal[];
flat in vec3 flux[];
flat out vec3 point_normal;
flat out vec3 point_flux;

void main() {
  if (layer[0] < 0) return;
  gl_Layer = layer[0];
  gl_Position = gl_in[0].gl_Position;
  gl_PointSize = 1.0;
  point_normal = normal[0];
  point_flux = flux[0];
  EmitVertex();
}
