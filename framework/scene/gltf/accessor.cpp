#include "scene/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace loom::scene::gltf {
namespace {

int components_of(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  if (type == "MAT4") return 16;
  return 0;
}

/// glTF 2.0, section 3.6.2.2 (Accessor data types): c/127 and c/32767 are held at −1.
template <class T>
float to_float(T value, bool normalized) {
  if constexpr (std::is_same_v<T, float>) {
    return value;
  } else if constexpr (std::is_signed_v<T>) {
    constexpr auto most = static_cast<float>(std::numeric_limits<T>::max());
    return normalized ? std::max(static_cast<float>(value) / most, -1.0f) : static_cast<float>(value);
  } else {
    constexpr auto most = static_cast<float>(std::numeric_limits<T>::max());
    return normalized ? static_cast<float>(value) / most : static_cast<float>(value);
  }
}

/// Elements in a run of bytes, all of which lie within it.
struct Source {
  Bytes bytes;
  std::size_t offset = 0, stride = 0, count = 0, components = 1;
  bool normalized = false;
  Selection selection = nullptr;
};

template <class T, class Out>
void copy_elements(const Source& source, Out* out) {
  const std::size_t count = source.selection == nullptr ? source.count : source.selection->size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t element = source.selection == nullptr ? i : (*source.selection)[i];
    const std::byte* at = source.bytes.data() + source.offset + element * source.stride;
    for (std::size_t c = 0; c < source.components; ++c) {
      T value;
      std::memcpy(&value, at + c * sizeof(T), sizeof(T));
      if constexpr (std::is_same_v<Out, float>) {
        *out++ = to_float(value, source.normalized);
      } else {
        *out++ = static_cast<Out>(value);
      }
    }
  }
}

template <class Out>
void copy_by_type(int type, const Source& source, Out* out) {
  switch (type) {
    case 5120:
      return copy_elements<std::int8_t>(source, out);
    case 5121:
      return copy_elements<std::uint8_t>(source, out);
    case 5122:
      return copy_elements<std::int16_t>(source, out);
    case 5123:
      return copy_elements<std::uint16_t>(source, out);
    case 5125:
      return copy_elements<std::uint32_t>(source, out);
    default:
      return copy_elements<float>(source, out);
  }
}

/// One column of a matrix starts at a multiple of 4 bytes, which makes 1- and 2-byte MAT2 and MAT3 longer than their
/// components; nothing that is read here uses those.
std::size_t element_bytes(const Accessor& accessor) {
  return component_bytes(accessor.component_type) * static_cast<std::size_t>(accessor.components);
}

std::vector<std::uint32_t> sparse_positions(Document& document, const Accessor& accessor) {
  const Sparse& sparse = *accessor.sparse;
  const Bytes bytes = document.view(sparse.index_view, accessor.pointer);
  std::vector<std::uint32_t> positions(sparse.count);
  copy_by_type(sparse.index_type, {bytes, sparse.index_offset, component_bytes(sparse.index_type), sparse.count},
               positions.data());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i] >= accessor.count || (i > 0 && positions[i] <= positions[i - 1])) {
      document.fail(accessor.pointer, "gltf-index", "its sparse indices must rise and stay below its count");
    }
  }
  return positions;
}

template <class Out>
std::vector<Out> read_dense(Document& document, const Accessor& accessor, Selection selection) {
  const auto components = static_cast<std::size_t>(accessor.components);
  std::vector<Out> numbers((selection == nullptr ? accessor.count : selection->size()) * components);
  if (accessor.view < 0) return numbers;
  const std::size_t stride = document.view_stride(accessor.view);
  copy_by_type(
      accessor.component_type,
      {document.view(accessor.view, accessor.pointer), accessor.offset, stride == 0 ? element_bytes(accessor) : stride,
       accessor.count, components, accessor.normalized, selection},
      numbers.data());
  return numbers;
}

template <class Out>
std::vector<Out> read_sparse_numbers(Document& document, const Accessor& accessor, Selection selection) {
  const auto components = static_cast<std::size_t>(accessor.components);
  const std::size_t element = element_bytes(accessor);
  std::vector<Out> all = read_dense<Out>(document, accessor, nullptr);
  const std::vector<std::uint32_t> positions = sparse_positions(document, accessor);
  const Bytes bytes = document.view(accessor.sparse->value_view, accessor.pointer);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    copy_by_type(accessor.component_type,
                 {bytes, accessor.sparse->value_offset + i * element, element, 1, components, accessor.normalized},
                 all.data() + positions[i] * components);
  }
  if (selection == nullptr) return all;
  std::vector<Out> numbers;
  numbers.reserve(selection->size() * components);
  for (const std::uint32_t i : *selection) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(i * components);
    numbers.insert(numbers.end(), from, from + static_cast<std::ptrdiff_t>(components));
  }
  return numbers;
}

template <class Out>
std::vector<Out> read_numbers(Document& document, int index, const std::string& user, Selection selection) {
  const Accessor& accessor = document.accessors()[static_cast<std::size_t>(index)];
  document.check_count(accessor);
  if (accessor.view < 0 && !accessor.sparse) {
    document.warn("gltf-accessor", "has no data and is read as zeros", accessor.pointer);
  }
  document.spend(selection == nullptr ? accessor.count : selection->size(), user);
  return accessor.sparse ? read_sparse_numbers<Out>(document, accessor, selection)
                         : read_dense<Out>(document, accessor, selection);
}

}  // namespace

void Document::read_accessors() {
  for (const Value& value : root().items("accessors")) accessors_.push_back(read_accessor(value));
}

Accessor Document::read_accessor(const Value& value) {
  const auto limit = static_cast<std::int64_t>(max_file_bytes);
  Accessor accessor;
  accessor.pointer = value.pointer();
  accessor.view = value.index("bufferView", views_.size(), "bufferViews");
  accessor.offset = static_cast<std::size_t>(value.integer("byteOffset", 0, 0, limit));
  accessor.count = static_cast<std::size_t>(value.integer("count", std::nullopt, 1, limit));
  accessor.component_type = static_cast<int>(value.integer("componentType", std::nullopt, 5120, 5126));
  if (component_bytes(accessor.component_type) == 0) value.fail("gltf-range", "its componentType is unknown");
  accessor.components = components_of(value.text("type"));
  if (accessor.components == 0) value.fail("gltf-range", "its type \"" + value.text("type") + "\" is unknown");
  accessor.normalized = value.flag("normalized", false);
  if (accessor.normalized && (accessor.component_type == 5126 || accessor.component_type == 5125)) {
    warn("gltf-accessor", "\"normalized\" has no meaning for float and 32-bit components", accessor.pointer);
    accessor.normalized = false;
  }
  const std::size_t element = element_bytes(accessor);
  if (accessor.view >= 0) {
    check_range(accessor, element);
  } else {
    if (value.has("byteOffset")) warn("gltf-accessor", "has a byteOffset, but no bufferView", accessor.pointer);
  }
  if (const std::optional<Value> sparse = value.find("sparse")) accessor.sparse = read_sparse(*sparse, accessor);
  return accessor;
}

void Document::check_count(const Accessor& accessor) const {
  constexpr std::size_t always_fine = 1u << 16;
  if (accessor.view < 0 && accessor.count > std::max(always_fine, total_bytes_)) {
    fail(accessor.pointer, "gltf-limit", "has " + std::to_string(accessor.count) + " elements, but no data");
  }
}

void Document::check_range(const Accessor& accessor, std::size_t element) {
  const View& view = views_[static_cast<std::size_t>(accessor.view)];
  const std::size_t stride = view.stride == 0 ? element : view.stride;
  if (stride < element) {
    fail(accessor.pointer, "gltf-range",
         "its elements of " + std::to_string(element) + " bytes do not fit into the stride of " +
             std::to_string(stride) + " bytes");
  }
  // No overflow: count ≤ 2^32, stride ≤ 252.
  const std::size_t end = accessor.offset + (accessor.count - 1) * stride + element;
  if (end > view.length) {
    fail(accessor.pointer, "gltf-range",
         "needs " + std::to_string(end) + " bytes, but its bufferView has " + std::to_string(view.length));
  }
  if ((accessor.offset + view.offset) % component_bytes(accessor.component_type) != 0) {
    warn("gltf-accessor", "is not aligned to its components", accessor.pointer);
  }
}

Sparse Document::read_sparse(const Value& value, const Accessor& accessor) {
  const auto limit = static_cast<std::int64_t>(max_file_bytes);
  Sparse sparse;
  sparse.count =
      static_cast<std::size_t>(value.integer("count", std::nullopt, 1, static_cast<std::int64_t>(accessor.count)));
  const Value indices = value.require("indices");
  sparse.index_view = indices.required_index("bufferView", views_.size(), "bufferViews");
  sparse.index_offset = static_cast<std::size_t>(indices.integer("byteOffset", 0, 0, limit));
  sparse.index_type = static_cast<int>(indices.integer("componentType", std::nullopt, 5121, 5125));
  if (sparse.index_type != 5121 && sparse.index_type != 5123 && sparse.index_type != 5125) {
    indices.fail("gltf-range", "its componentType is no unsigned integer");
  }
  const Value values = value.require("values");
  sparse.value_view = values.required_index("bufferView", views_.size(), "bufferViews");
  sparse.value_offset = static_cast<std::size_t>(values.integer("byteOffset", 0, 0, limit));
  const auto fits = [&](int view, std::size_t offset, std::size_t bytes, const Value& where) {
    if (offset + sparse.count * bytes > views_[static_cast<std::size_t>(view)].length) {
      where.fail("gltf-range", "goes past the end of its bufferView");
    }
  };
  fits(sparse.index_view, sparse.index_offset, component_bytes(sparse.index_type), indices);
  fits(sparse.value_view, sparse.value_offset, element_bytes(accessor), values);
  return sparse;
}

std::vector<float> read_floats(Document& document, int accessor, const std::string& user, Selection selection) {
  return read_numbers<float>(document, accessor, user, selection);
}

std::vector<std::uint32_t> read_indices(Document& document, int accessor, const std::string& user) {
  const Accessor& a = document.accessors()[static_cast<std::size_t>(accessor)];
  const bool is_unsigned = a.component_type == 5121 || a.component_type == 5123 || a.component_type == 5125;
  if (a.components != 1 || !is_unsigned || a.normalized) {
    document.fail(user, "gltf-type", a.pointer + " must hold unsigned integer scalars");
  }
  return read_numbers<std::uint32_t>(document, accessor, user, nullptr);
}

}  // namespace loom::scene::gltf
