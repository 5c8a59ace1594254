#include "loom/resolution.h"

#include <utility>

namespace loom {
namespace {

glm::ivec2 blocks(glm::ivec2 size, int resolution) { return (size + resolution - 1) / resolution; }

}  // namespace

void Resolution::params(Params& p) {
  p.integer("resolution", resolution_,
            {.min = 1,
             .max = 8,
             .unit = "pixels",
             .scale = Scale::log,
             .cost = Cost::graph,
             .doc = "n: computed at one pixel of n×n, and at those whose surface no such pixel around them shows; the "
                    "others are filled along surfaces"});
}

void Resolution::declare(Ports& ports, int channels, int parts) {
  parts_ = parts;
  if (parts > 1)
    ports.scratch("sum", TextureDesc::image(ports.frame_size(), Format::rgba32f), Access::image_read_write);
  if (resolution_ == 1) return;
  const auto size = blocks(ports.frame_size(), resolution_);
  ports.scratch("coarse", TextureDesc::image(size, Format::rgba32f).with_channels(channels), Access::image_read_write);
}

void Resolution::prepare(Device& device, const ProgramDesc& desc) {
  const auto program = [&](const char* stage) {
    ProgramDesc staged = desc;
    staged.defines.insert(staged.defines.end(), {{"RESOLUTION_FULL", "0"},
                                                 {"RESOLUTION_COARSE", "1"},
                                                 {"RESOLUTION_FINE", "2"},
                                                 {"RESOLUTION", stage},
                                                 {"PARTS", parts_ > 1 ? "1" : "0"}});
    return device.program(staged);
  };
  const bool full = resolution_ == 1;
  coarse_ = full ? nullptr : program("RESOLUTION_COARSE");
  fine_ = program(full ? "RESOLUTION_FULL" : "RESOLUTION_FINE");
}

void Resolution::dispatch_parts(Frame& frame, const Bindings& bindings, const Program& program, glm::ivec2 size) const {
  for (int part = 0; part < parts_; ++part) {
    if (part > 0) frame.barrier();
    program.set("part", glm::ivec2(part, parts_));
    frame.dispatch(program, bindings, {size, 1});
  }
}

void Resolution::dispatch(Frame& frame, const Bindings& bindings) const {
  if (coarse_) {
    dispatch_parts(frame, bindings, *coarse_, blocks(frame.size(), resolution_));
    frame.barrier();
  }
  dispatch_parts(frame, bindings, *fine_, frame.size());
}

void Resolution::each_program(const std::function<void(const Program&)>& set) const {
  for (const auto& program : {coarse_, fine_})
    if (program) set(*program);
}

}  // namespace loom
