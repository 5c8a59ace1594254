// Fragment stage of every scene draw: what the surface is. Sample everything before `discard`, so that derivatives are
// defined. Surfaces: diffuse albedo ρ = baseColor·(1−metallic)·(1−transmission); nothing is culled; the back of a single-sided face
// reflects but does not emit.
#ifndef LOOM_LIB_MATERIAL_GLSL
#define LOOM_LIB_MATERIAL_GLSL
#include "lib/math.glsl"
#include "lib/scene_materials.glsl"
#define SCENE_VARYING in
#include "lib/scene_varyings.glsl"

layout(std430) readonly restrict buffer scene_draws { Draw draws[]; };
// Unit normals of the triangles of each primitive, in its own space, counter-clockwise.
layout(std430) readonly restrict buffer scene_triangles { vec4 triangle_normals[]; };

#ifdef SCENE_TEXTURES
// Bound by SceneView::draw, material by material.
uniform sampler2D material_base_color;  // linear rgb (decoded from sRGB) and alpha
uniform sampler2D material_emissive;    // linear rgb
uniform sampler2D material_metallic;    // g: roughness, b: metallic
#endif
#ifdef SCENE_NORMAL_MAPS
uniform sampler2D material_normal;
#endif

bool has_flag(uint flag) { return (vertex.ids.z & flag) != 0u; }

// True on the counter-clockwise side, whatever the transform.
bool surface_front() { return gl_FrontFacing != has_flag(SCENE_MIRRORED); }

// Base colour and alpha before the cutoff.
vec4 surface_base_color() {
  vec4 base = materials[vertex.ids.x].base_color * vertex.color;
#ifdef SCENE_TEXTURES
  if (has_flag(MATERIAL_BASE_COLOR_TEXTURE)) {
    base *= texture(material_base_color, vertex.base_color_uv);
  }
#endif
  return base;
}

// False where the material's mask cuts the surface away. Alpha comes from the full-size image: the mean of a mask over
// a footprint (a mip level), compared with the cutoff, is not the mean of the comparison, and thin leaves would vanish.
bool surface_visible() {
#ifdef SCENE_ALPHA_MASK
  if (!has_flag(MATERIAL_MASK)) return true;
  float alpha = materials[vertex.ids.x].base_color.a * vertex.color.a;
#ifdef SCENE_TEXTURES
  if (has_flag(MATERIAL_BASE_COLOR_TEXTURE)) {
    alpha *= textureLod(material_base_color, vertex.base_color_uv, 0.).a;
  }
#endif
  return alpha >= materials[vertex.ids.x].emissive.w;
#else
  return true;
#endif
}

float surface_metallic() {
  float metallic = materials[vertex.ids.x].factors.x;
#ifdef SCENE_TEXTURES
  if (has_flag(MATERIAL_METALLIC_TEXTURE)) {
    metallic *= texture(material_metallic, vertex.metallic_uv).b;
  }
#endif
  return metallic;
}

// Share of the light that passes the outside of a dielectric and is refracted; 0 where surfaces are lambert.
float surface_transmission() { return materials[vertex.ids.x].factors.w; }
float surface_ior() { return materials[vertex.ids.x].dielectric.x; }

vec3 surface_albedo() {
  return surface_base_color().rgb * (1. - surface_metallic()) * (1. - surface_transmission());
}

// rgb: F₀ = mix(((ior−1)/(ior+1))², baseColor, metallic), reflectance along the normal; a: α = roughness² of the GGX
// distribution. Matte surfaces have F₀ = 0: none of their light is specular.
vec4 surface_specular() {
  float roughness = materials[vertex.ids.x].factors.z;
#ifdef SCENE_TEXTURES
  if (has_flag(MATERIAL_METALLIC_TEXTURE)) {
    roughness *= texture(material_metallic, vertex.metallic_uv).g;
  }
#endif
  float ior = surface_ior(), amplitude = (ior - 1.) / (ior + 1.);
  vec4 specular =
      vec4(mix(vec3(amplitude * amplitude), surface_base_color().rgb, surface_metallic()), roughness * roughness);
  return has_flag(MATERIAL_SPECULAR) ? specular : vec4(0, 0, 0, 1);
}

// Exitant radiance of a side that emits, W/(m² sr).
vec3 emitted_radiance() {
  vec3 radiance = materials[vertex.ids.x].emissive.rgb;
#ifdef SCENE_TEXTURES
  if (has_flag(MATERIAL_EMISSIVE_TEXTURE)) {
    radiance *= texture(material_emissive, vertex.emissive_uv).rgb;
  }
#endif
  return radiance;
}

// Exitant radiance towards the viewer, W/(m² sr).
vec3 surface_emission() {
  return surface_front() || has_flag(MATERIAL_DOUBLE_SIDED) ? emitted_radiance() : vec3(0);
}

// Unit normal of the triangle, world, towards the viewer.
vec3 surface_geometric_normal() {
  uint triangle = vertex.ids.y + uint(gl_PrimitiveID);
  vec3 n = mat3(draws[vertex.ids.w].normal) * triangle_normals[triangle].xyz;
  return normalize_or(surface_front() ? n : -n, vec3(0, 1, 0));
}

// Unit shading normal, world, on the viewer's side of the triangle.
vec3 surface_normal() {
  vec3 n = normalize_or(vertex.normal, vec3(0, 1, 0));
#ifdef SCENE_NORMAL_MAPS
  if (has_flag(MATERIAL_NORMAL_TEXTURE)) {
    // The tangent is made orthogonal to the interpolated normal; a mirroring transform turns n × t around.
    vec3 t = normalize_or(vertex.tangent.xyz - n * dot(n, vertex.tangent.xyz), orthonormal_basis(n)[0]);
    vec3 b = cross(n, t) * (vertex.tangent.w < 0. ? -1. : 1.) * (has_flag(SCENE_MIRRORED) ? -1. : 1.);
    vec3 m = 2. * texture(material_normal, vertex.normal_uv).xyz - 1.;
    m.xy *= materials[vertex.ids.x].factors.y;
    n = normalize_or(mat3(t, b, n) * m, n);
  }
#endif
  return surface_front() ? n : -n;
}
#endif
