#include "graph/run/structs.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "loom/diagnostic.h"

namespace loom::graph {

BundleStructs::BundleStructs(const CompiledGraph& graph) {
  for (const Bundle& bundle : graph.bundles) {
    Entry entry{.name = bundle.name, .type = bundle.type, .bytes = std::vector<std::byte>(bundle.struct_bytes)};
    if (bundle.struct_bytes > 0) entry.buffer.emplace_back(bundle.struct_bytes, bundle.name + " struct");
    if (bundle.history) {
      const std::string_view base = std::string_view(bundle.name).substr(0, bundle.name.rfind('@'));
      const auto it = std::find_if(graph.bundles.begin(), graph.bundles.end(),
                                   [&](const Bundle& b) { return !b.history && b.name == base; });
      entry.history_of = it == graph.bundles.end() ? none : static_cast<int>(it - graph.bundles.begin());
    }
    entries_.push_back(std::move(entry));
  }
}

void BundleStructs::publish(int bundle, std::span<const std::byte> data, const std::string& what) {
  Entry& entry = entries_[static_cast<std::size_t>(bundle)];
  if (data.size() != entry.bytes.size())
    throw Error(fmt::format("{} publishes {} bytes, but the struct of {} has {}", what, data.size(), entry.type,
                            entry.bytes.size()));
  if (std::equal(data.begin(), data.end(), entry.bytes.begin())) return;
  std::copy(data.begin(), data.end(), entry.bytes.begin());
  entry.buffer.front().write(data);
}

std::span<const std::byte> BundleStructs::data(int bundle, std::size_t bytes, const std::string& what) const {
  const Entry& entry = entries_[static_cast<std::size_t>(bundle)];
  if (bytes != entry.bytes.size())
    throw Error(
        fmt::format("{} reads {} bytes, but the struct of {} has {}", what, bytes, entry.type, entry.bytes.size()));
  return entry.bytes;
}

const Buffer* BundleStructs::buffer(int bundle) const {
  const Entry& entry = entries_[static_cast<std::size_t>(bundle)];
  return entry.buffer.empty() ? nullptr : &entry.buffer.front();
}

void BundleStructs::poison(int bundle) {
  Entry& entry = entries_[static_cast<std::size_t>(bundle)];
  std::fill(entry.bytes.begin(), entry.bytes.end(), std::byte{0xff});
  for (const Buffer& buffer : entry.buffer) buffer.write(entry.bytes);
}

void BundleStructs::swap_history() {
  for (Entry& entry : entries_) {
    if (entry.history_of == none) continue;
    Entry& now = entries_[static_cast<std::size_t>(entry.history_of)];
    std::swap(entry.bytes, now.bytes);
    std::swap(entry.buffer, now.buffer);
  }
}

Adopted BundleStructs::adopt(const BundleStructs& from) {
  std::vector<Entry*> state;
  for (Entry& entry : entries_) {
    if (entry.history_of == none) continue;
    state.push_back(&entry);
    state.push_back(&entries_[static_cast<std::size_t>(entry.history_of)]);
  }
  Adopted adopted;
  for (Entry* entry : state) {
    const auto old = std::find_if(from.entries_.begin(), from.entries_.end(), [&](const Entry& e) {
      return e.name == entry->name && e.type == entry->type && e.bytes.size() == entry->bytes.size();
    });
    if (old == from.entries_.end()) {
      adopted.history = false;
      continue;
    }
    entry->bytes = old->bytes;
    for (const Buffer& buffer : entry->buffer) buffer.write(entry->bytes);
  }
  return adopted;
}

void BundleStructs::reset() {
  for (Entry& entry : entries_) {
    std::fill(entry.bytes.begin(), entry.bytes.end(), std::byte{0});
    for (const Buffer& buffer : entry.buffer) buffer.clear();
  }
}

}  // namespace loom::graph
