#pragma once
// Program binaries on disk. A file that is damaged or of another driver is as good as none.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace loom::gpu {

struct ProgramBinary {
  unsigned int format = 0;
  std::vector<std::byte> bytes;
};

class ProgramCache {
 public:
  /// `dir` as in DeviceOptions::cache_dir. A folder that cannot be made is a warning and no cache.
  explicit ProgramCache(const std::string& dir);
  [[nodiscard]] bool enabled() const { return !dir_.empty(); }
  [[nodiscard]] std::optional<ProgramBinary> load(const std::string& key) const;
  void store(const std::string& key, const ProgramBinary& binary);

 private:
  [[nodiscard]] std::string path(const std::string& key) const;
  void trim() const;
  std::string dir_;
};

}  // namespace loom::gpu
