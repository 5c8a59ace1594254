#pragma once
// Device with a program cache in memory and on disk.
#include <memory>
#include <string>
#include <vector>

#include "loom/export.h"
#include "loom/gpu.h"

namespace loom::gpu {

struct ProgramStats {
  int compiled = 0;   ///< built from source
  int from_disk = 0;  ///< restored from a program binary
};

struct DeviceOptions {
  std::vector<std::string> shader_roots;  ///< searched in order for files and #include "…"
  std::string cache_dir;                  ///< program binaries; empty: $XDG_CACHE_HOME/lightloom, "-": none
};

class LOOM_API CachingDevice : public Device {
 public:
  static std::unique_ptr<CachingDevice> create(DeviceOptions options);
  [[nodiscard]] virtual ProgramStats stats() const = 0;
  /// Files that a program was made of, for hot reload.
  [[nodiscard]] virtual std::vector<std::string> sources_of(const Program& program) const = 0;
  /// Files of all programs there are.
  [[nodiscard]] virtual std::vector<std::string> sources() const = 0;
  /// Drops programs made of that file, so that the next program() compiles them again.
  virtual void invalidate(const std::string& file) = 0;
};

}  // namespace loom::gpu
