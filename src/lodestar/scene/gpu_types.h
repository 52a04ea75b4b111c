// SPDX-License-Identifier: Apache-2.0
// The scene as shaders read it. C++ and GLSL, scalar layout.
#ifndef LS_GPU_TYPES_H
#define LS_GPU_TYPES_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_NO_TEXTURE = 0xffffffffu;
const uint LS_TEXTURE_ARRAYS = 8u;

// A visible triangle: cluster << 7 | triangle of its meshlet; 0 = background (cluster 0 is unused).
const uint LS_TRIANGLE_BITS = 7u;
const uint LS_TRIANGLE_MASK = 127u;
// An index for the raster pipeline: cluster << 6 | vertex of its meshlet.
const uint LS_VERTEX_BITS = 6u;
const uint LS_VERTEX_MASK = 63u;

struct GpuVertex {
    vec3 position;
    uint normal;   // packNormal
    uint tangent;  // packTangent
    vec2 uv0;
    vec2 uv1;
    uint color;  // unorm 4x8, linear
};

struct GpuMeshlet {
    vec3 centre;  // object space
    float radius;
    vec3 coneAxis;
    float coneCutoff;
    uint vertexOffset;    // into the meshlet vertices
    uint triangleOffset;  // into the meshlet triangles
    uint counts;          // vertices | triangles << 8
    uint material;
};

const uint LS_INSTANCE_REFLECTED = 1u;    // negative determinant: the winding turns around
const uint LS_INSTANCE_CONE_VALID = 2u;   // uniform scale: meshlet normal cones hold

struct GpuInstance {
    vec4 row0, row1, row2;  // world from object, an affine matrix by rows
    float maxScale;         // of the matrix, for bounding spheres
    uint flags;
};

/// A meshlet of an instance: what is culled, drawn and named in triangle ids.
struct GpuCluster {
    uint instance;
    uint meshlet;
};

const uint LS_WRAP_REPEAT = 0u;
const uint LS_WRAP_MIRROR = 1u;
const uint LS_WRAP_CLAMP = 2u;

struct GpuTextureUse {
    uint array;    // LS_NO_TEXTURE: none
    uint layer;
    uint reading;  // wrapU | wrapV << 2 | nearest << 4 | uvSet << 5 | transformed << 6
    vec3 uRow;     // u' = dot(uRow, (u, v, 1))
    vec3 vRow;
};

const uint LS_MATERIAL_MASK = 1u;
const uint LS_MATERIAL_DOUBLE_SIDED = 2u;
const uint LS_MATERIAL_UNLIT = 4u;

struct GpuMaterial {
    vec4 baseColor;
    vec3 emissive;
    float metallic;
    float roughness;
    float normalScale;
    float occlusionStrength;
    float alphaCutoff;
    uint flags;
    GpuTextureUse baseColorTexture;
    GpuTextureUse normalTexture;
    GpuTextureUse metallicRoughnessTexture;
    GpuTextureUse occlusionTexture;
    GpuTextureUse emissiveTexture;
};

struct GpuLight {
    vec3 position;  // world
    float range;    // 0 = no limit
    vec3 color;     // linear, intensity multiplied in [cd]
    uint kind;      // 1 point, 2 spot
    vec3 direction; // the way it shines, world
    float coneScale, coneOffset;  // spot: clamp(cos·scale + offset, 0, 1)²
};

LS_NAMESPACE_END

#ifdef __cplusplus
namespace lodestar::shared {
static_assert(sizeof(GpuVertex) == 40 && sizeof(GpuMeshlet) == 48 && sizeof(GpuInstance) == 56);
static_assert(sizeof(GpuTextureUse) == 36 && sizeof(GpuMaterial) == 48 + 4 + 5 * 36);
static_assert(sizeof(GpuLight) == 52);
}  // namespace lodestar::shared
#endif
#endif
