#pragma once
// Which pass types and bundle types there are. Filled by plugins, read by the compiler; a plain object, never global.
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "loom/bundles.h"
#include "loom/export.h"
#include "loom/pass.h"

namespace loom {

struct PassType {
  std::string name;
  std::string summary;
  std::string plugin;  ///< path of the library that brought it, empty = the program itself
  std::function<std::unique_ptr<Pass>()> create;
};

class LOOM_API Registry {
 public:
  Registry();  ///< knows the built-in bundle types
  ~Registry();
  Registry(Registry&&) noexcept;
  Registry& operator=(Registry&&) noexcept;

  /// Throws Error (`duplicate-type`) naming both plugins where the name is taken.
  void add_pass(PassType type);
  /// An identical declaration merges; another of the same name throws Error (`bundle-conflict`) that names both.
  void add_bundle(BundleType type, std::string_view plugin = {});
  template <class P>
  void add(const std::string& name, const std::string& summary) {
    add_pass(
        {.name = name, .summary = summary, .plugin = current_plugin_, .create = [] { return std::make_unique<P>(); }});
  }

  [[nodiscard]] const PassType* pass(std::string_view name) const;
  [[nodiscard]] const BundleType* bundle(std::string_view name) const;
  [[nodiscard]] const std::vector<PassType>& passes() const { return passes_; }  ///< sorted by name
  [[nodiscard]] const std::vector<BundleType>& bundles() const { return bundles_; }

  /// Set by the loader while a plugin registers; all it added is undone if it throws.
  void set_current_plugin(std::string path) { current_plugin_ = std::move(path); }
  void remove_plugin(std::string_view path);
  /// Keeps `owner` (a loaded library) alive as long as the registry, released after all pass types.
  void keep(std::shared_ptr<void> owner);

 private:
  std::vector<std::shared_ptr<void>> owners_;  // declared first: destroyed last
  std::vector<PassType> passes_;
  std::vector<BundleType> bundles_;
  std::vector<std::string> bundle_plugins_;
  std::string current_plugin_;
};

}  // namespace loom
