// SPDX-License-Identifier: Apache-2.0
// What C++ and GLSL must agree on, written once. GLSL sees it through glslc's #include; both sides
// use scalar layout. Included by every *_params.h.
#ifndef LS_TYPES_H
#define LS_TYPES_H

#ifdef __cplusplus
#include <cstdint>

#include <glm/glm.hpp>

#define LS_NAMESPACE_BEGIN namespace lodestar::shared {
#define LS_NAMESPACE_END }
namespace lodestar::shared {
using glm::ivec2;
using glm::ivec3;
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
}  // namespace lodestar::shared
#else
#extension GL_EXT_scalar_block_layout : require
#define LS_NAMESPACE_BEGIN
#define LS_NAMESPACE_END
#endif

#endif
