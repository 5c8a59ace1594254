#include "loom/registry.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "loom/diagnostic.h"

namespace loom {
namespace {

std::string bringer(std::string_view plugin) {
  return plugin.empty() ? "the program itself" : "`" + std::string(plugin) + "`";
}

auto position(const std::vector<PassType>& passes, std::string_view name) {
  return std::lower_bound(passes.begin(), passes.end(), name,
                          [](const PassType& type, std::string_view wanted) { return type.name < wanted; });
}

[[noreturn]] void refuse(std::string code, std::string message, std::string hint) {
  Diagnostics diagnostics;
  diagnostics.error(std::move(code), std::move(message), {}, std::move(hint));
  throw Error(std::move(diagnostics));
}

}  // namespace

Registry::Registry() : bundles_(builtin_bundles()), bundle_plugins_(bundles_.size()) {}

Registry::~Registry() {
  passes_.clear();  // their functions are code of the libraries that owners_ keeps loaded
}

Registry::Registry(Registry&&) noexcept = default;

Registry& Registry::operator=(Registry&& other) noexcept {
  if (this != &other) {
    passes_ = std::move(other.passes_);  // drops the old types before the old owners
    bundles_ = std::move(other.bundles_);
    bundle_plugins_ = std::move(other.bundle_plugins_);
    current_plugin_ = std::move(other.current_plugin_);
    owners_ = std::move(other.owners_);
  }
  return *this;
}

void Registry::add_pass(PassType type) {
  if (type.plugin.empty()) type.plugin = current_plugin_;
  const auto at = position(passes_, type.name);
  if (at != passes_.end() && at->name == type.name)
    refuse("duplicate-type",
           "pass type `" + type.name + "` of " + bringer(type.plugin) + " is already brought by " + bringer(at->plugin),
           "rename one of them, or remove one of the plugins");
  passes_.insert(at, std::move(type));
}

void Registry::add_bundle(BundleType type, std::string_view plugin) {
  const std::string_view source = plugin.empty() ? std::string_view(current_plugin_) : plugin;
  for (std::size_t i = 0; i < bundles_.size(); ++i) {
    if (bundles_[i].name != type.name) continue;
    if (bundles_[i].same_layout(type)) return;
    refuse("bundle-conflict",
           "bundle type `" + type.name + "` (version " + std::to_string(type.version) + ") of " + bringer(source) +
               " differs from that of " + bringer(bundle_plugins_[i]) + " (version " +
               std::to_string(bundles_[i].version) + ")",
           "members, struct size and version must be the same; give another meaning another name");
  }
  bundles_.push_back(std::move(type));
  bundle_plugins_.emplace_back(source);
}

const PassType* Registry::pass(std::string_view name) const {
  const auto at = position(passes_, name);
  return at != passes_.end() && at->name == name ? &*at : nullptr;
}

const BundleType* Registry::bundle(std::string_view name) const {
  const auto it = std::find_if(bundles_.begin(), bundles_.end(), [&](const auto& b) { return b.name == name; });
  return it == bundles_.end() ? nullptr : &*it;
}

void Registry::remove_plugin(std::string_view path) {
  std::erase_if(passes_, [&](const PassType& type) { return type.plugin == path; });
  for (std::size_t i = bundles_.size(); i-- > 0;) {
    if (path.empty() || bundle_plugins_[i] != path) continue;
    bundles_.erase(bundles_.begin() + static_cast<std::ptrdiff_t>(i));
    bundle_plugins_.erase(bundle_plugins_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void Registry::keep(std::shared_ptr<void> owner) { owners_.push_back(std::move(owner)); }

}  // namespace loom
