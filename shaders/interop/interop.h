// Shared by C++ and GLSL: one declaration of every struct that both sides read. All members are 16-byte multiples, so
// that std140, std430 and C++ agree; each header states the size it asserts.
#ifndef LOOM_INTEROP_H
#define LOOM_INTEROP_H
#ifdef __cplusplus
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#define LOOM_STRUCT_SIZE(type, bytes) static_assert(sizeof(type) == (bytes))
#define LOOM_INTEROP_BEGIN namespace loom::interop { using glm::ivec2; using glm::ivec4; using glm::mat4; using glm::uvec4; using glm::vec2; using glm::vec4;
#define LOOM_INTEROP_END }
#else
// GLSL 4.5 has no empty declaration: something without effect has to stand before the semicolon.
#define LOOM_STRUCT_SIZE(type, bytes) precision highp float
#define LOOM_INTEROP_BEGIN
#define LOOM_INTEROP_END
#endif
#endif
