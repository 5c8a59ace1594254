# loom_add_pass(): the one line of a pass's CMakeLists.txt. Builds <folder>.cpp into lib/loom/passes/<folder>.so.
# Works in this tree and, through find_package(Loom), out of tree. Extra arguments are further sources.
function(loom_add_pass)
  get_filename_component(name ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(target pass_${name})
  add_library(${target} MODULE ${name}.cpp ${ARGN})
  target_link_libraries(${target} PRIVATE Loom::loom)
  if(TARGET loom_options)
    target_link_libraries(${target} PRIVATE loom_options)
  endif()
  # -fno-gnu-unique: without it dlclose() never unloads, and hot reload keeps the old code.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_compile_definitions(${target} PRIVATE "LOOM_BUILD_TAG=\"${LOOM_BUILD_TAG}\"")
  if(PROJECT_NAME STREQUAL "Loom")
    set(output ${CMAKE_BINARY_DIR}/lib/loom/passes)
  else()
    set(output ${CMAKE_BINARY_DIR})
  endif()
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${output}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  # Out of tree, the shaders of a pass lie beside its source; the loader looks for shaders/ beside the plugin. Links, so
  # that a change needs no build.
  file(GLOB shaders RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/shaders ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*)
  foreach(shader ${shaders})
    file(MAKE_DIRECTORY ${output}/shaders)
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/shaders/${shader} ${output}/shaders/${shader} SYMBOLIC)
  endforeach()
  if(PROJECT_NAME STREQUAL "Loom")
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/../..")
    add_dependencies(lightloom ${target})
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/loom/passes)
  endif()
endfunction()
