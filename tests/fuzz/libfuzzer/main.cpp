// One target under libFuzzer (cmake -DLOOM_FUZZ=ON with clang): LOOM_FUZZ_TARGET is its name.
#include <cstddef>
#include <cstdint>
#include <span>

#include "fuzz/targets.h"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  loom::fuzz::LOOM_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}
