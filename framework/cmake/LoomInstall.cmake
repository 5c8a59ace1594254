# The layout of an installation, which can be moved as a whole:
#   bin/loom  lib/libloom.so  lib/loom/passes/*.so  lib/cmake/Loom
#   include/loom  include/interop
#   share/loom/{pipelines,shaders,configs}
include(CMakePackageConfigHelpers)

set_target_properties(loom_cli PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
set_target_properties(loom PROPERTIES EXPORT_NAME loom)

install(TARGETS loom EXPORT LoomTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS loom_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY framework/include/loom shaders/interop DESTINATION include)
install(DIRECTORY pipelines shaders configs DESTINATION ${CMAKE_INSTALL_DATADIR}/loom)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Loom)
install(EXPORT LoomTargets NAMESPACE Loom:: DESTINATION ${package_dir})
configure_package_config_file(framework/cmake/LoomConfig.cmake.in ${CMAKE_BINARY_DIR}/LoomConfig.cmake
  INSTALL_DESTINATION ${package_dir})
# Before 1.0 a change of the minor number may change the plugin ABI.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/LoomConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/LoomConfig.cmake ${CMAKE_BINARY_DIR}/LoomConfigVersion.cmake
              framework/cmake/LoomAddPass.cmake framework/cmake/LoomBuildTag.cmake DESTINATION ${package_dir})
