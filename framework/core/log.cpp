#include "core/log.h"

#include <memory>

#include <spdlog/sinks/stdout_color_sinks.h>

namespace loom {

spdlog::logger& log() {
  // Never destroyed: an OpenGL context that is destroyed among the static objects may still have something to say.
  static const auto* const logger = new std::shared_ptr<spdlog::logger>([] {
    auto made = std::make_shared<spdlog::logger>("loom", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    made->set_pattern("%^%l%$: %v");
    made->set_level(spdlog::level::info);
    made->flush_on(spdlog::level::warn);
    return made;
  }());
  return **logger;
}

}  // namespace loom
