#include "plugins/library.h"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>
#include <system_error>

#include "core/image_io.h"

namespace loom::plugins {
namespace {

const char* const rebuild_hint = "rebuild it against this Lightloom: find_package(Loom) and loom_add_pass()";

std::string to_string(const Version& version) {
  return "ABI " + std::to_string(version.abi) + ", build " + version.build_tag;
}

std::string bound(const char* text) { return text == nullptr ? "(none)" : text; }

/// False, with the reason in `diagnostics`, where the two cannot share C++ objects.
bool compatible(const std::string& path, const Version& theirs, Diagnostics& diagnostics) {
  const Version ours = own_version();
  if (theirs.abi != ours.abi) {
    diagnostics.error(
        "plugin-abi",
        "made for plugin ABI " + std::to_string(theirs.abi) + ", this Lightloom has ABI " + std::to_string(ours.abi),
        {.file = path}, rebuild_hint);
    return false;
  }
  if (theirs.build_tag != ours.build_tag) {
    diagnostics.error(
        "plugin-build",
        "built as " + theirs.build_tag + ", this Lightloom as " + ours.build_tag + "; C++ objects cannot be shared",
        {.file = path}, rebuild_hint);
    return false;
  }
  return true;
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// False for a library that was cut short: dlopen() maps it all the same, and the process dies at the first page that
/// is not there. What is no library at all is left to dlopen() to name.
bool is_whole(const std::string& bytes) {
  ElfW(Ehdr) header;
  if (bytes.size() < sizeof(header) || bytes.compare(0, SELFMAG, ELFMAG) != 0) return true;
  std::memcpy(&header, bytes.data(), sizeof(header));
  for (std::size_t i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment;
    const std::size_t at = header.e_phoff + i * sizeof(segment);
    if (at > bytes.size() || bytes.size() - at < sizeof(segment)) return false;
    std::memcpy(&segment, bytes.data() + at, sizeof(segment));
    if (segment.p_type != PT_LOAD) continue;
    if (segment.p_offset > bytes.size() || bytes.size() - segment.p_offset < segment.p_filesz) return false;
  }
  return true;
}

std::optional<Version> stamp_in(const std::string& bytes) {
  const std::size_t at = bytes.find(PluginStamp::marker);
  if (at == std::string::npos || bytes.size() - at < sizeof(PluginStamp)) return std::nullopt;
  PluginStamp stamp;
  std::memcpy(&stamp, bytes.data() + at, sizeof(stamp));
  return Version{.abi = stamp.abi, .build_tag = {stamp.build_tag, strnlen(stamp.build_tag, sizeof(stamp.build_tag))}};
}

/// The last error of dlopen() or dlsym().
std::string dl_error() { return bound(dlerror()); }

/// A file of that content under a name that no library of this process has had; gone with this object.
class TemporaryCopy {
 public:
  TemporaryCopy(const std::string& path, const std::string& bytes) {
    static std::atomic<unsigned> count = 0;
    const auto name = std::filesystem::path(path).stem().string() + "-" + std::to_string(getpid()) + "-" +
                      std::to_string(count++) + ".so";
    path_ = std::filesystem::temp_directory_path() / name;
    write_file_atomic(path_.string(), std::as_bytes(std::span(bytes)));
  }
  ~TemporaryCopy() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryCopy(const TemporaryCopy&) = delete;
  TemporaryCopy& operator=(const TemporaryCopy&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace

Version own_version() { return {.abi = plugin_abi, .build_tag = LOOM_BUILD_TAG}; }

std::optional<Version> stamped_version(const std::string& path) { return stamp_in(read_bytes(path)); }

std::optional<Library> open_library(const std::string& path, bool copy, Diagnostics& diagnostics) {
  const std::string bytes = read_bytes(path);
  if (!is_whole(bytes)) {
    diagnostics.error("plugin-load", "is cut short", {.file = path}, "build or copy it again");
    return std::nullopt;
  }
  const std::optional<Version> stamped = stamp_in(bytes);
  if (stamped && !compatible(path, *stamped, diagnostics)) return std::nullopt;

  // NOW: a missing symbol shows here, not in the middle of a frame. LOCAL: plugins do not see each other's symbols.
  std::optional<TemporaryCopy> own;
  try {
    if (copy) own.emplace(path, bytes);
  } catch (const std::exception& error) {
    diagnostics.error("plugin-load", std::string("cannot be copied: ") + error.what(), {.file = path},
                      "TMPDIR names the folder for temporary files");
    return std::nullopt;
  }
  std::shared_ptr<void> handle(dlopen((own ? own->path() : path).c_str(), RTLD_NOW | RTLD_LOCAL), [](void* library) {
    if (library != nullptr) dlclose(library);
  });
  if (!handle) {
    diagnostics.error("plugin-load",
                      "the dynamic linker says: " + dl_error() +
                          " (plugin: " + (stamped ? to_string(*stamped) : std::string("version unknown")) +
                          "; this Lightloom: " + to_string(own_version()) + ")",
                      {.file = path}, "link what it needs, or rebuild it with loom_add_pass()");
    return std::nullopt;
  }
  using Entry = const LoomPlugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(handle.get(), "loom_plugin"));
  if (entry == nullptr) {
    diagnostics.error("plugin-symbol", "has no loom_plugin(): " + dl_error(), {.file = path},
                      "a plugin is made by the macro LOOM_PLUGIN; other libraries do not belong in this folder");
    return std::nullopt;
  }
  const LoomPlugin* plugin = entry();
  if (plugin == nullptr) {
    diagnostics.error("plugin-symbol", "loom_plugin() returned nothing", {.file = path}, rebuild_hint);
    return std::nullopt;
  }
  // Only `abi` and `struct_bytes` lie at the same place in every version: check them before reading further.
  if (plugin->abi == plugin_abi && plugin->struct_bytes != sizeof(LoomPlugin)) {
    diagnostics.error("plugin-abi",
                      "its LoomPlugin struct has " + std::to_string(plugin->struct_bytes) +
                          " bytes, this Lightloom's has " + std::to_string(sizeof(LoomPlugin)) + " (both say ABI " +
                          std::to_string(plugin_abi) + ")",
                      {.file = path}, rebuild_hint);
    return std::nullopt;
  }
  const bool same_abi = plugin->abi == plugin_abi;
  if (!compatible(path, {.abi = plugin->abi, .build_tag = same_abi ? bound(plugin->build_tag) : ""}, diagnostics)) {
    return std::nullopt;
  }
  if (plugin->name == nullptr || plugin->add_to == nullptr) {
    diagnostics.error("plugin-symbol", "its LoomPlugin struct lacks a name or add_to", {.file = path}, rebuild_hint);
    return std::nullopt;
  }
  return Library{.handle = std::move(handle), .plugin = plugin};
}

}  // namespace loom::plugins
