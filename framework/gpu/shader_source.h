#pragma once
// GLSL files with #include "…", expanded to one text per stage, and the way back from a driver's log to file:line.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "loom/export.h"
#include "loom/gpu.h"

namespace loom::gpu {

/// One stage, ready for the driver. `#version 450 core` and the defines stand at the top; every included file opens
/// with
/// `#line 1 n`, where n is its index in `files`.
struct ShaderSource {
  unsigned int stage = 0;  ///< GL_COMPUTE_SHADER, …
  std::string name;        ///< as asked for: "gather_rsm/gather.comp"
  std::string text;
  std::vector<std::string> files;  ///< paths as found
};

/// Finds `name` below the roots (first hit wins; an absolute path stands for itself) and expands it. An include is
/// looked up beside the including file, then below the roots. Files guard themselves as C headers do (#ifndef or
/// #pragma once). Includes are expanded whether or not a surrounding #if holds; `#include <…>` is for C++ alone and
/// dropped. Throws Error (`shader-file`, `shader-include`, `shader-stage`) with file:line of the include.
LOOM_API ShaderSource load_shader(const std::string& name, std::span<const std::string> roots,
                                  std::span<const Define> defines);

/// The driver's log with its source-string numbers replaced by file names: Mesa `2:14(7): error`, NVIDIA
/// `2(14) : error`, AMD and Intel `ERROR: 2:14:`.
LOOM_API std::string name_files(std::string_view log, const std::vector<std::string>& files);

}  // namespace loom::gpu
