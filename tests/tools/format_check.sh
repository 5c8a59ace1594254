#!/usr/bin/env bash
# Every C++ file is as clang-format leaves it. With --fix it is made so. The interop headers are GLSL too, and left out.
cd "$(dirname "$0")/../.." || exit 1
mode=(--dry-run --Werror)
[ "${1:-}" = --fix ] && mode=(-i)
find framework passes tests docs \( -name '*.cpp' -o -name '*.h' \) -print0 2>/dev/null |
  xargs -0 -r clang-format "${mode[@]}"
