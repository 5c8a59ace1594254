#pragma once
// A 128-bit content hash for cache keys (two FNV-1a lanes); not for security.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <fmt/core.h>

namespace loom::gpu {

class Hash128 {
 public:
  Hash128& add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      // Offsets and prime of 64-bit FNV-1a; the second lane starts elsewhere and sees each byte inverted.
      a_ = (a_ ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
      b_ = (b_ ^ static_cast<std::uint64_t>(~byte & std::byte{0xff})) * 0x100000001b3u;
    }
    return *this;
  }
  /// Length first, so that ("ab", "c") and ("a", "bc") differ.
  Hash128& add(std::string_view text) {
    const std::uint64_t length = text.size();
    return add(std::as_bytes(std::span(&length, 1))).add(std::as_bytes(std::span(text)));
  }
  [[nodiscard]] std::string hex() const { return fmt::format("{:016x}{:016x}", a_, b_); }

 private:
  std::uint64_t a_ = 0xcbf29ce484222325u;
  std::uint64_t b_ = 0x84222325cbf29ce4u;
};

}  // namespace loom::gpu
