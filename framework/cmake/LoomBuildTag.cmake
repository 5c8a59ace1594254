# LOOM_BUILD_TAG: what two binaries must agree on to share C++ objects across a plugin boundary. The framework and every
# plugin work it out from their own build by these lines; the loader refuses a plugin whose tag is another.
set(LOOM_BUILD_TAG "${CMAKE_CXX_COMPILER_ID}-${CMAKE_CXX_COMPILER_VERSION}")
if(LOOM_SANITIZE OR CMAKE_CXX_FLAGS MATCHES "-fsanitize=[a-z,]*address")
  string(APPEND LOOM_BUILD_TAG "-sanitize")
endif()
