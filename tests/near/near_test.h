#pragma once
// ScreenSpaceGI on surfaces that shine evenly, in pictures whose answer is known.
#include <string>
#include <vector>

#include "filter/filter_test.h"

namespace loom::test {

class NearTest : public FilterTest {
 protected:
  /// The passes `gbuffer`, `lit` (what surfaces emit), `emitter` (exact, nothing blocks), `near`, and `more`.
  /// `in`: further wires of `near`; `params`: its parameters.
  static std::string near_pipeline(const std::string& params = "", const std::string& in = "",
                                   const std::string& more = "") {
    return R"({ "passes": { )" + (more.empty() ? R"("gbuffer": { "type": "GBuffer" })" : more) + R"(,
      "lit": { "type": "Composite", "in": { "surface": "gbuffer.surface" } },
      "emitter": { "type": "AreaLight", "in": { "surface": "gbuffer.surface" }, "params": { "visibility": "none", "closed_form": 256 } },
      "near": { "type": "ScreenSpaceGI", "in": { "surface": "gbuffer.surface", "radiance": "lit.radiance")" +
           in + R"( }, "params": { )" + params + R"( } } },
      "outputs": { "image": "near.irradiance", "unknown": "near.unknown", "emitter": "emitter.irradiance",
                   "depth": "gbuffer.surface.depth", "normal": "gbuffer.surface.normal" } })";
  }
};

}  // namespace loom::test
