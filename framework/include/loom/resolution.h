#pragma once
// The size at which a pass finds irradiance: each pixel of the picture, or one of each block of n×n, from which the
// others are filled along surfaces (joint bilateral upsampling; shaders/lib/resolution.glsl has the weights). Where a
// pixel's own surface is in none of the four blocks around it, it is computed like the others: edges stay sharp, and
// thin things are not lost. A constant stays what it is.
//
// A pass holds one, and its shader defines `vec3 irradiance_at(ivec2 pixel)` and includes lib/resolution.glsl:
//   params()   resolution_.params(p);                       declares the parameter `resolution`
//   reflect()  resolution_.declare(ports, channels);        after its output `irradiance` is declared
//   prepare()  resolution_.prepare(device, desc);           its program
//   execute()  resolution_.dispatch(frame, bindings);
#include <functional>
#include <memory>

#include <glm/vec2.hpp>

#include "loom/export.h"
#include "loom/frame.h"
#include "loom/gpu.h"
#include "loom/params.h"
#include "loom/ports.h"

namespace loom {

class LOOM_API Resolution {
 public:
  void params(Params& p);
  [[nodiscard]] bool full() const { return resolution_ == 1; }
  /// Declares the scratch texture `coarse` where the size is a part of the frame's. The pass reads depth and normal of
  /// its input `surface`, and has an output `irradiance`. `parts`: dispatches that the samples of a pixel are shared
  /// out over (loom/rounds.h); the shader asks lib/parts.glsl for its share.
  void declare(Ports& ports, int channels, int parts = 1);
  void prepare(Device& device, const ProgramDesc& desc);
  void dispatch(Frame& frame, const Bindings& bindings) const;
  /// For uniforms of the pass's own, in each of its programs.
  void each_program(const std::function<void(const Program&)>& set) const;

 private:
  void dispatch_parts(Frame& frame, const Bindings& bindings, const Program& program, glm::ivec2 size) const;

  int resolution_ = 1, parts_ = 1;
  std::shared_ptr<const Program> coarse_, fine_;
};

}  // namespace loom
