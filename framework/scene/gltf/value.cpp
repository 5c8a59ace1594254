#include "scene/gltf/value.h"

#include <cmath>
#include <utility>

namespace loom::scene::gltf {

void fail(const std::string& file, const std::string& pointer, std::string code, std::string message,
          std::string hint) {
  if (!pointer.empty()) message = pointer + ": " + message;
  throw BadInput(
      Diagnostic{Severity::error, std::move(code), std::move(message), {file, 0, 0, pointer}, std::move(hint)});
}

void Value::fail(std::string code, std::string message, std::string hint) const {
  gltf::fail(*file_, pointer_, std::move(code), std::move(message), std::move(hint));
}

std::optional<Value> Value::find(std::string_view key) const {
  if (!json_->is_object()) fail("gltf-type", std::string("must be an object, but is ") + json_->type_name());
  const auto found = json_->find(key);
  if (found == json_->end()) return std::nullopt;
  return Value(*found, pointer_ + "/" + std::string(key), *file_);
}

Value Value::require(std::string_view key) const {
  std::optional<Value> found = find(key);
  if (!found) fail("gltf-missing", "has no \"" + std::string(key) + "\"");
  return *found;
}

std::optional<Value> Value::extension(std::string_view name) const {
  const std::optional<Value> extensions = find("extensions");
  if (!extensions) return std::nullopt;
  std::optional<Value> found = extensions->find(name);
  if (found && !found->json().is_object()) found->fail("gltf-type", "must be an object");
  return found;
}

std::vector<Value> Value::items(std::string_view key) const {
  const std::optional<Value> array = find(key);
  std::vector<Value> list;
  if (!array) return list;
  if (!array->json().is_array()) {
    array->fail("gltf-type", std::string("must be an array, but is ") + array->json().type_name());
  }
  list.reserve(array->json().size());
  for (std::size_t i = 0; i < array->json().size(); ++i) {
    list.emplace_back(array->json()[i], array->pointer() + "/" + std::to_string(i), *file_);
  }
  return list;
}

std::vector<std::pair<std::string, Value>> Value::members() const {
  if (!json_->is_object()) fail("gltf-type", "must be an object");
  std::vector<std::pair<std::string, Value>> list;
  for (const auto& [key, value] : json_->items()) list.emplace_back(key, Value(value, pointer_ + "/" + key, *file_));
  return list;
}

double Value::as_number() const {
  if (!json_->is_number()) fail("gltf-type", std::string("must be a number, but is ") + json_->type_name());
  const double value = json_->get<double>();
  if (!std::isfinite(value)) fail("gltf-range", "is not finite");
  return value;
}

std::int64_t Value::integer(std::string_view key, std::optional<std::int64_t> fallback, std::int64_t min,
                            std::int64_t max) const {
  const std::optional<Value> found = find(key);
  if (!found) {
    if (!fallback) fail("gltf-missing", "has no \"" + std::string(key) + "\"");
    return *fallback;
  }
  // Up to 2^53 a double holds every integer, and no file is longer.
  const double value = found->as_number();
  if (value != std::floor(value)) found->fail("gltf-type", "must be an integer");
  if (value < static_cast<double>(min) || value > static_cast<double>(max)) {
    found->fail("gltf-range", "is " + found->json().dump() + ", but must lie within " + std::to_string(min) + " and " +
                                  std::to_string(max));
  }
  return static_cast<std::int64_t>(value);
}

int Value::as_index(std::size_t count, std::string_view things) const {
  const double value = as_number();
  if (value != std::floor(value)) fail("gltf-type", "must be an integer");
  if (value < 0 || value >= static_cast<double>(count)) {
    fail("gltf-index", "is " + json_->dump() + ", but there are " + std::to_string(count) + " " + std::string(things));
  }
  return static_cast<int>(value);
}

int Value::index(std::string_view key, std::size_t count, std::string_view things) const {
  const std::optional<Value> found = find(key);
  return found ? found->as_index(count, things) : -1;
}

int Value::required_index(std::string_view key, std::size_t count, std::string_view things) const {
  return require(key).as_index(count, things);
}

double Value::number(std::string_view key, std::optional<double> fallback, double min, double max) const {
  const std::optional<Value> found = find(key);
  if (!found) {
    if (!fallback) fail("gltf-missing", "has no \"" + std::string(key) + "\"");
    return *fallback;
  }
  const double value = found->as_number();
  if (value < min || value > max) {
    found->fail("gltf-range", "is " + found->json().dump() + ", which is out of range");
  }
  return value;
}

std::string Value::text(std::string_view key, std::string_view fallback) const {
  const std::optional<Value> found = find(key);
  if (!found) return std::string(fallback);
  if (!found->json().is_string()) found->fail("gltf-type", "must be a string");
  return found->json().get<std::string>();
}

bool Value::flag(std::string_view key, bool fallback) const {
  const std::optional<Value> found = find(key);
  if (!found) return fallback;
  if (!found->json().is_boolean()) found->fail("gltf-type", "must be true or false");
  return found->json().get<bool>();
}

std::vector<double> Value::numbers(std::string_view key, std::size_t count) const {
  std::vector<double> list;
  const std::vector<Value> values = items(key);
  if (values.empty() && !has(key)) return list;
  if (values.size() != count) {
    require(key).fail("gltf-type",
                      "must hold " + std::to_string(count) + " numbers, but holds " + std::to_string(values.size()));
  }
  for (const Value& value : values) list.push_back(value.as_number());
  return list;
}

}  // namespace loom::scene::gltf
