#pragma once
// What the tables of the volume pipelines have in common: the names to measure, and a device to do it on.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "support/gl.h"

namespace loom::test {

/// Those that the command line names, else all.
inline std::vector<std::string> volume_pipelines(int argc, char** argv) {
  if (argc > 1) return {argv + 1, argv + argc};
  return {"rsm",
          "lpv",
          "lpv-cascaded",
          "lpv-surface",
          "lpv-voxel",
          "radiance-field",
          "radiance-field-voxel",
          "ray-march",
          "ray-march-probes",
          "cone-trace"};
}

/// Null, and said why, where there is no OpenGL.
inline std::unique_ptr<gpu::CachingDevice> table_device() {
  std::string why;
  if (shared_context(why)) return gpu::CachingDevice::create({.shader_roots = source_shader_roots(), .cache_dir = "-"});
  std::fprintf(stderr, "%s\n", why.c_str());
  return nullptr;
}

}  // namespace loom::test
