#include "loom/bundles.h"

#include <algorithm>

#include "interop/camera.h"
#include "interop/grid.h"
#include "interop/light.h"
#include "interop/probes.h"
#include "interop/vpl.h"

namespace loom {

bool BundleType::same_layout(const BundleType& other) const {
  return name == other.name && version == other.version && struct_bytes == other.struct_bytes &&
         std::equal(members.begin(), members.end(), other.members.begin(), other.members.end(),
                    [](const BundleMember& a, const BundleMember& b) {
                      return a.name == b.name && a.kind == b.kind && a.unit == b.unit;
                    });
}

const BundleMember* BundleType::find(std::string_view member) const {
  const auto it = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.name == member; });
  return it == members.end() ? nullptr : &*it;
}

const std::vector<BundleType>& builtin_bundles() {
  constexpr auto texture = MemberKind::texture;
  constexpr auto buffer = MemberKind::buffer;
  static const std::vector<BundleType> types = {
      {.name = "Surface",
       .members = {{"depth", texture, "m", "distance along the camera ray; 0 where nothing is seen"},
                   {"normal", texture, "", "unit shading normal, world, towards the viewer"},
                   {"geometric_normal", texture, "", "unit normal of the triangle, world, towards the viewer"},
                   {"albedo", texture, "", "diffuse albedo ρ = baseColor·(1−metallic)·(1−transmission)"},
                   {"emission", texture, "W/(m² sr)", "exitant radiance towards the viewer"},
                   {"specular", texture, "", "rgb: reflectance along the normal F₀; a: α = roughness² of GGX"},
                   {"transmission", texture, "", "r: refracted share of a dielectric's light; g: its index"}},
       .struct_bytes = sizeof(interop::Camera),
       .doc = "The nearest surface at each pixel (G-buffer), with the camera that saw it"},
      {.name = "LightLayers",
       .members = {{"flux", texture, "W", "reflected flux Φ of each texel, one layer a light face"},
                   {"normal", texture, "", "unit geometric normal, world, towards the light"},
                   {"depth", texture, "m", "radial distance from the light (directional: along it); 0 = nothing"},
                   {"shadow", texture, "", "hardware depth (reversed) at shadow_size"},
                   {"faces", buffer, "", "LightFace of each layer (shaders/interop/light.h)"}},
       .struct_bytes = sizeof(interop::LightLayers),
       .doc = "What each light sees (reflective shadow maps), one layer a light face"},
      {.name = "GeometryImage",
       .members = {{"position", texture, "m",
                    "world position; a: the area in m² that the point stands for, 0 = no point"},
                   {"normal", texture, "", "unit geometric normal, world"},
                   {"albedo", texture, "", "diffuse albedo"},
                   {"flux", texture, "W", "flux that leaves the point on the side of its normal"}},
       .doc = "Points of surfaces, one a texel; `buffers`: in how many equal groups of layers surfaces are seen anew"},
      {.name = "ShVolume",
       .members = {{"red", texture, "W/sr", "SH coefficients of the red channel, or of luminance"},
                   {"green", texture, "W/sr", "SH coefficients of the green channel"},
                   {"blue", texture, "W/sr", "SH coefficients of the blue channel"}},
       .struct_bytes = sizeof(interop::Grid),
       .doc = "A directional function at each cell of a grid, as spherical harmonics"},
      {.name = "VoxelScene",
       .members =
           {{"occupancy", texture, "", "blocked share of each cell's three lower faces"},
            {"directional", texture, "", "blocked share by direction of travel at each cell's lower corner, SH"},
            {"coverage", texture, "", "opaque share of the sheet of each dominant axis; w: 1 where there is any"},
            {"plane", texture, "", "of each sheet: mean normal times its flatness, and offset in cells"},
            {"extent", texture, "", "rectangle that each sheet spans across its axis, in cells"},
            {"centroid", texture, "", "mean position of each side of each sheet from the cell's centre, in cells"},
            {"albedo", texture, "",
             "mean diffuse albedo, by face axis (3 slabs) or side of sheet (6 slabs; a: its area in cell faces)"},
            {"emission", texture, "W/(m² sr)", "exitant radiance of emitters, by side of sheet"},
            {"radiance", texture, "W/(m² sr)", "reflected radiance, by side of sheet"}},
       .struct_bytes = sizeof(interop::Grid),
       .doc = "The scene in a grid: shares of cell faces (occupancy), or sheets, up to three a cell (docs/voxels.md)"},
      {.name = "ProbeField",
       .members = {{"coefficients", texture, "W/(m² sr)", "radiance coefficients of each probe"},
                   {"moments", texture, "m", "mean and mean square of the radial distance, by direction"},
                   {"state", texture, "m", "offset of the probe from its grid point, and whether it is on"}},
       .struct_bytes = sizeof(interop::ProbeGrid),
       .doc = "Radiance at the probes of a grid"},
      {.name = "VplSet",
       .members = {{"lights", buffer, "W",
                    "how many there are, and position, normal, flux of each (shaders/interop/vpl.h)"}},
       .struct_bytes = sizeof(interop::VplSet),
       .doc = "Virtual point lights; `most`: how many there can be, `orders`: of one path"},
      {.name = "VplShadows",
       .members =
           {{"maps", texture, "m",
             "octahedral map of each light's hemisphere: unit normal of what it sees, and distance (0: nothing)"},
            {"of", buffer, "", "by light: 1 + layer of its map, 0 = it has none"}},
       .struct_bytes = sizeof(interop::VplShadows),
       .doc = "What the brightest lights of a VplSet see, one layer a light"},
      {.name = "Irradiance",
       .members = {{"irradiance", texture, "W/m²", "irradiance at each pixel's surface"}},
       .doc = "Irradiance at the visible surface, RGB"},
      {.name = "Image", .members = {{"image", texture, "", "RGBA"}}, .doc = "A picture; `quantity` says of what"},
  };
  return types;
}

}  // namespace loom
