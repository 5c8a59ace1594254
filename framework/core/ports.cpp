#include "loom/ports.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include "loom/diagnostic.h"

namespace loom {
namespace {

MemberDecl& member_of(OutputDecl& output, std::string_view name) {
  const auto it =
      std::find_if(output.members.begin(), output.members.end(), [&](const auto& m) { return m.name == name; });
  if (it == output.members.end())
    throw Error("output `" + output.name + "` declares no member `" + std::string(name) + "`; declare it first");
  return *it;
}

}  // namespace

InputPort& InputPort::optional() {
  ports_->inputs[index_].optional = true;
  return *this;
}

InputPort& InputPort::reads(std::string_view member, Access access) {
  ports_->inputs[index_].reads.push_back({std::string(member), access});
  return *this;
}

InputPort& InputPort::reads_all() {
  ports_->inputs[index_].reads_all = true;
  return *this;
}

const BundleInfo* InputPort::info() const {
  const auto it = ports_->upstream_.find(ports_->inputs[index_].name);
  return it == ports_->upstream_.end() ? nullptr : &it->second;
}

bool InputPort::connected() const { return info() != nullptr; }

bool InputPort::absent() const {
  const BundleInfo* bundle = info();
  return bundle == nullptr || bundle->absent.has_value();
}

std::string InputPort::why_absent() const {
  const BundleInfo* bundle = info();
  if (bundle == nullptr) return "input `" + ports_->inputs[index_].name + "` is not wired";
  return bundle->absent.value_or("");
}

const TextureDesc* InputPort::texture(std::string_view member) const {
  const BundleInfo* bundle = info();
  if (bundle == nullptr || bundle->absent) return nullptr;
  for (const auto& candidate : bundle->members)
    if (candidate.name == member) return std::get_if<TextureDesc>(&candidate.desc);
  return nullptr;
}

int InputPort::attribute(std::string_view name, int fallback) const {
  const BundleInfo* bundle = info();
  if (bundle == nullptr) return fallback;
  const auto it = bundle->attributes.find(name);
  if (it == bundle->attributes.end()) return fallback;
  const int* value = std::get_if<int>(&it->second);
  return value == nullptr ? fallback : *value;
}

std::string InputPort::attribute(std::string_view name, std::string_view fallback) const {
  const BundleInfo* bundle = info();
  if (bundle != nullptr) {
    const auto it = bundle->attributes.find(name);
    if (it != bundle->attributes.end())
      if (const auto* value = std::get_if<std::string>(&it->second)) return *value;
  }
  return std::string(fallback);
}

OutputPort& OutputPort::texture(std::string_view member, const TextureDesc& desc, Access access) {
  ports_->outputs[index_].members.push_back({.name = std::string(member), .desc = desc, .access = access});
  return *this;
}

OutputPort& OutputPort::buffer(std::string_view member, const BufferDesc& desc, Access access) {
  ports_->outputs[index_].members.push_back({.name = std::string(member), .desc = desc, .access = access});
  return *this;
}

OutputPort& OutputPort::cleared(std::string_view member, glm::vec4 value) {
  MemberDecl& decl = member_of(ports_->outputs[index_], member);
  decl.clear = value;
  decl.clear_each_frame = true;
  return *this;
}

OutputPort& OutputPort::initial(std::string_view member, glm::vec4 value) {
  member_of(ports_->outputs[index_], member).clear = value;
  return *this;
}

OutputPort& OutputPort::needed(std::string_view member) {
  member_of(ports_->outputs[index_], member).needed = true;
  return *this;
}

OutputPort& OutputPort::needed(std::string_view member, std::string_view whenever) {
  member_of(ports_->outputs[index_], member).needed_for.emplace_back(whenever);
  return *this;
}

OutputPort& OutputPort::attribute(std::string_view name, Attribute value) {
  ports_->outputs[index_].attributes.insert_or_assign(std::string(name), std::move(value));
  return *this;
}

void OutputPort::absent(std::string why) { ports_->outputs[index_].absent = std::move(why); }

void OutputPort::forwards(std::string_view input) { ports_->outputs[index_].forwards = std::string(input); }

OutputPort& OutputPort::in_place(std::string_view input) {
  ports_->outputs[index_].in_place = std::string(input);
  return *this;
}

Ports::Ports(glm::ivec2 frame_size, Upstream upstream, std::function<bool(std::string_view)> rule_enabled)
    : frame_size_(frame_size), upstream_(std::move(upstream)), rule_enabled_(std::move(rule_enabled)) {}

InputPort Ports::in(std::string_view name, std::string_view bundle_type) {
  inputs.push_back({.name = std::string(name), .type = std::string(bundle_type)});
  return {*this, inputs.size() - 1};
}

OutputPort Ports::out(std::string_view name, std::string_view bundle_type) {
  outputs.push_back({.name = std::string(name), .type = std::string(bundle_type)});
  return {*this, outputs.size() - 1};
}

void Ports::scratch(std::string_view name, const TextureDesc& desc, Access access) {
  scratches.push_back({.name = std::string(name), .desc = desc, .access = access});
}

void Ports::scratch(std::string_view name, const BufferDesc& desc) {
  scratches.push_back({.name = std::string(name), .desc = desc, .access = Access::storage_write});
}

void Ports::persistent(std::string_view name, const TextureDesc& desc, Access access, glm::vec4 clear) {
  persistents.push_back({.name = std::string(name), .desc = desc, .access = access, .clear = clear});
}

void Ports::persistent(std::string_view name, const BufferDesc& desc) {
  persistents.push_back({.name = std::string(name), .desc = desc, .access = Access::storage_write});
}

void Ports::keep_outputs(Keep what) {
  keeps_outputs = rule("static");
  renews_parts = keeps_outputs && what == Keep::parts;
}
void Ports::side_effect() { has_side_effect = true; }

bool Ports::rule(std::string_view name) const { return !rule_enabled_ || rule_enabled_(name); }

void Ports::decide(std::string rule, std::string decision, std::string evidence) {
  if (this->rule(rule)) decisions.push_back({std::move(rule), std::move(decision), std::move(evidence), {}});
}

void Ports::error(std::string code, std::string message, std::string hint) {
  issues.push_back({std::move(code), std::move(message), std::move(hint)});
}

}  // namespace loom
