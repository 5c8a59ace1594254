# Warnings and sanitizers, for every target of this tree.
add_library(loom_options INTERFACE)
target_compile_options(loom_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
                       $<$<AND:$<CONFIG:Release>,$<BOOL:$<TARGET_PROPERTY:LOOM_LIGHT>>>:-O1>
                       -Wno-missing-field-initializers)  # designated initialisers leave the rest at its default
# GCC 12 sees overlapping copies in `"x" + std::string` (its bug 105329).
target_compile_options(loom_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(LOOM_FUZZ)
  # What clang finds beyond GCC is clang-tidy's business.
  target_compile_options(loom_options INTERFACE -fsanitize=fuzzer-no-link -Wno-error)
endif()
if(LOOM_SANITIZE OR LOOM_FUZZ)
  target_compile_options(loom_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                -fno-omit-frame-pointer)
  # Most of a sanitized run is its build. -O1 where the time of a test is spent, -O0 elsewhere, and line tables alone:
  # reports lose nothing but variables.
  target_compile_options(loom_options INTERFACE
    $<IF:$<STREQUAL:$<TARGET_PROPERTY:TYPE>,SHARED_LIBRARY>,-O1,-O0> -g1)
  target_link_options(loom_options INTERFACE -fsanitize=address,undefined)
  # Instrumented code hides from GCC 12 that <regex> initialises its states.
  target_compile_options(loom_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()

# loom_precompile(TARGET HEADER...): precompiled headers, in the sanitized build alone, so that the release build still
# shows that each file includes what it uses.
function(loom_precompile target)
  if(LOOM_SANITIZE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# loom_light(TARGET): glue, in which no time is spent but the compiler's: -O1 in a release. Of the tests and the command
# line that is a third of their build.
function(loom_light target)
  set_target_properties(${target} PROPERTIES LOOM_LIGHT ON)
endfunction()

include(LoomBuildTag)
