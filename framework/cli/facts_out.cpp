#include "cli/facts_out.h"

#include <cstddef>
#include <cstdio>

#include "loom/rules.h"

namespace loom::cli {
namespace {

Json measured_json(const SceneMeasurements& m, const glm::dvec3& origin) {
  Json above = Json::array();
  for (std::size_t order = 0; order < SceneMeasurements::bands; ++order)
    above.push_back(rules::above_band(m, static_cast<int>(order)));
  return {{"lit_min", vector_json(m.lit_min + origin)},
          {"lit_max", vector_json(m.lit_max + origin)},
          {"seen_min", vector_json(m.seen_min + origin)},
          {"seen_max", vector_json(m.seen_max + origin)},
          {"thinnest_occluder_m", m.thinnest_occluder},
          {"sheets", m.sheets},
          {"probes", m.probes},
          {"radiance_by_band", m.radiance},
          {"visibility_by_band", m.visibility},
          {"irradiance_above_order", above}};
}

const char* reflection(const SceneFacts& facts) {
  if (!facts.ggx) return "diffuse (lambert)";
  if (!facts.specular) return "ggx, every surface matte";
  return facts.transmission ? "ggx: specular and transparent surfaces" : "ggx: specular surfaces";
}

const char* yes(bool value) { return value ? "yes" : "no"; }

void print_box(const char* name, const glm::dvec3& low, const glm::dvec3& high) {
  std::printf("  %-11s (%g, %g, %g) to (%g, %g, %g) m\n", name, low.x, low.y, low.z, high.x, high.y, high.z);
}

void print_measured(const SceneMeasurements& m, const glm::dvec3& origin) {
  print_box("lit", m.lit_min + origin, m.lit_max + origin);
  print_box("seen", m.seen_min + origin, m.seen_max + origin);
  std::printf("  occluders   thinnest %g m; %.1f %% of the surface is sheets without an inside\n", m.thinnest_occluder,
              100 * m.sheets);
  std::printf("  spectrum at %d probes, share of the mean square\n", m.probes);
  std::printf("    band   reflected light   visibility   irradiance above it\n");
  for (std::size_t l = 0; l < SceneMeasurements::bands; ++l)
    std::printf("    %4zu   %15.5f   %10.5f   %19.6f\n", l, m.radiance.at(l), m.visibility.at(l),
                rules::above_band(m, static_cast<int>(l)));
}

}  // namespace

void add_facts(Json& document, const SceneFacts& facts, const glm::dvec3& origin) {
  document["triangles"] = facts.triangles;
  document["bounds_min"] = vector_json(facts.bounds_min + origin);
  document["bounds_max"] = vector_json(facts.bounds_max + origin);
  document["max_albedo"] = facts.max_albedo;
  document["max_chroma"] = facts.max_chroma;
  document["max_emission"] = facts.max_emission;
  document["thinnest_feature_m"] = facts.thinnest_feature;
  document["light_faces"] = facts.light_faces();
  document["emissive_triangles"] = facts.emissive_triangles;
  document["emissive_area_m2"] = facts.emissive_area;
  document["emitted_power_w"] = facts.emitted_power;
  document["alpha_mask"] = facts.alpha_mask;
  document["normal_maps"] = facts.normal_maps;
  document["surfaces"] = facts.ggx ? "ggx" : "lambert";
  document["specular"] = facts.specular;
  document["transmission"] = facts.transmission;
  document["moves"] = facts.moves;
  document["moving_triangles"] = facts.moving_triangles;
  document["geometry_moves"] = facts.geometry_moves;
  document["lights_move"] = facts.lights_move;
  document["camera_moves"] = facts.camera_moves;
  document["measured"] = facts.measured ? measured_json(*facts.measured, origin) : Json(nullptr);
}

void print_facts(const SceneFacts& f, const glm::dvec3& origin) {
  print_box("bounds", f.bounds_min + origin, f.bounds_max + origin);
  std::printf("  features    thinnest %g m, by the boxes of meshes\n", f.thinnest_feature);
  std::printf("  lights      %d spot, %d wide spot, %d point, %d directional: %d faces\n", f.spot_lights,
              f.wide_spot_lights, f.point_lights, f.directional_lights, f.light_faces());
  std::printf("  albedo      at most %.3g, chroma at most %.3g\n", f.max_albedo, f.max_chroma);
  std::printf("  emission    %d triangles, %g m2, %g W, at most %g W/(m2 sr)\n", f.emissive_triangles, f.emissive_area,
              f.emitted_power, f.max_emission);
  std::printf("  reflection  %s\n", reflection(f));
  std::printf("  surfaces    alpha mask %s, normal maps %s, textures %s\n", yes(f.alpha_mask), yes(f.normal_maps),
              yes(f.textures));
  std::printf("  moves       geometry %s (%zu triangles), lights %s, camera %s\n", yes(f.geometry_moves),
              f.moving_triangles, yes(f.lights_move), yes(f.camera_moves));
  if (f.measured) print_measured(*f.measured, origin);
}

}  // namespace loom::cli
