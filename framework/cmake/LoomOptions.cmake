# Warnings and sanitizers, for every target of this tree.
add_library(loom_options INTERFACE)
target_compile_options(loom_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
                       -Wno-missing-field-initializers)  # designated initialisers leave the rest at its default
# GCC 12 sees overlapping copies in `"x" + std::string` (its bug 105329).
target_compile_options(loom_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(LOOM_SANITIZE)
  target_compile_options(loom_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                -fno-omit-frame-pointer)
  # -O1 and line tables alone compile in about half the time of -O2 -g; reports lose nothing but variables.
  target_compile_options(loom_options INTERFACE -O1 -g1)
  target_link_options(loom_options INTERFACE -fsanitize=address,undefined)
  # Instrumented code hides from GCC 12 that <regex> initialises its states.
  target_compile_options(loom_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()

include(LoomBuildTag)
