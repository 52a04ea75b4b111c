// SPDX-License-Identifier: Apache-2.0
// The scene as shaders read it: records of 16-byte words (uvec4), fetched from texel buffers by the
// functions of scene.glsl. C++ and GLSL.
#ifndef LS_GPU_TYPES_H
#define LS_GPU_TYPES_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_NO_TEXTURE = 0xffffffffu;
const uint LS_TEXTURE_ARRAYS = 8u;

// A visible triangle: cluster << 7 | triangle of its meshlet; 0 = background (cluster 0 is unused).
const uint LS_TRIANGLE_BITS = 7u;
const uint LS_TRIANGLE_MASK = 127u;

/// What a ray needs to meet the surface.
struct GpuVertex {
    vec3 position;
    uint normal;  // packNormal
};

/// What a material needs.
struct GpuVertexAttributes {
    vec2 uv;
    uint tangent;  // packTangent
    uint color;    // unorm 4x8, linear
};

/// Vertices of one stored triangle, in the order of the mesh.
struct GpuTriangle {
    uint a, b, c;
    uint own;  // the same as numbers within its meshlet: a | b << 8 | c << 16
};

struct GpuMeshlet {
    vec3 centre;  // object space
    float radius;
    vec3 coneAxis;
    float coneCutoff;
    uint triangles;  // first of its GpuTriangles
    uint vertices;   // first of its vertices' numbers
    uint material;
    uint counts;  // LS_MESHLET_*
};

// GpuMeshlet::counts: triangles | vertices << 8 | level of its mesh << 16, 0 = finest.
const uint LS_MESHLET_VERTICES = 64u;  // at most
const uint LS_MESHLET_VERTICES_SHIFT = 8u;
const uint LS_MESHLET_LOD_SHIFT = 16u;

const uint LS_MAX_LODS = 15u;

struct GpuMesh {
    vec3 centre;  // object space
    float radius;
    uint firstLod;
    uint lodCount;
    uint bin;  // scene::DrawBin
    uint unused;
};

/// One level of detail of a mesh.
struct GpuLod {
    uint firstMeshlet;
    uint meshletCount;
    float error;  // how far the surface may lie from that of level 0, object units
    uint unused;
};

/// Up to LS_CHUNK instances near one another that are drawn with the same pipeline.
struct GpuChunk {
    vec3 centre;  // world
    float radius;
    uint first;  // in the order of drawing
    uint count;
    uint unused0, unused1;
};

const uint LS_CHUNK = 64u;
const uint LS_MAX_INSTANCES = 1u << 25;

/// A visible meshlet of an instance: what is drawn and named in triangle ids. Records are written
/// anew for every view (geometry/cull.hpp).
struct GpuCluster {
    uint instance;
    uint meshlet;
    uint triangles;  // first of its GpuTriangles
    uint material;
    uint triangleCount;
    uint lod;
    uint bin;  // scene::DrawBin
    uint unused;
};

const uint LS_INSTANCE_REFLECTED = 1u;   // negative determinant: the winding turns around
const uint LS_INSTANCE_CONE_VALID = 2u;  // uniform scale: meshlet normal cones hold

struct GpuInstance {
    vec4 row0, row1, row2;  // world from object, an affine matrix by rows
    float maxScale;         // of the matrix, for bounding spheres
    uint flags;
    uint mesh;
    uint displaced;  // its GpuDisplaced; 0 = none
};

/// An instance of a displaced mesh. Record 0 is that of all others.
struct GpuDisplaced {
    float amplitude;   // object units
    float wavelength;  // of the first octave, object units
    uint octaves;
    uint instance;
    uint firstPair;
    uint firstMeshlet;  // of the mesh's finest level
    uint meshletCount;
    uint unused;
};

/// A meshlet of a displaced instance. Pair 0 is unused.
struct GpuDisplacedPair {
    uint displaced;
    uint meshlet;
};

/// The refined part of a displaced instance, written on the device (geometry/tessellate.hpp):
/// meshlets beyond those of its mesh.
struct GpuRefined {
    uint firstMeshlet;
    uint meshletCount;
};

const uint LS_LOD_REFINED = 15u;  // level of those meshlets: above any of a mesh

const uint LS_WRAP_REPEAT = 0u;
const uint LS_WRAP_MIRROR = 1u;
const uint LS_WRAP_CLAMP = 2u;

// A material's use of a texture, in one word: array | layer << 3 | reading << 16, or LS_NO_TEXTURE.
const uint LS_ARRAY_MASK = 7u;
const uint LS_LAYER_SHIFT = 3u;
const uint LS_LAYER_MASK = 0x1fffu;
const uint LS_READING_SHIFT = 16u;
// reading: wrapU | wrapV << 2 | the flags
const uint LS_READ_NEAREST = 16u;
const uint LS_READ_UV1 = 32u;
const uint LS_READ_TRANSFORMED = 64u;

const uint LS_MATERIAL_MASK = 1u;
const uint LS_MATERIAL_DOUBLE_SIDED = 2u;
const uint LS_MATERIAL_UNLIT = 4u;
const uint LS_MATERIAL_BLEND = 8u;  // something of it is seen through; alphaCutoff on it is opaque

const uint LS_MATERIAL_WORDS = 15u;  // uvec4s a material takes

struct GpuMaterial {
    vec4 baseColor;
    vec3 emissive;
    uint flags;
    float metallic, roughness, normalScale, occlusionStrength;
    uint baseColorTexture, normalTexture, metallicRoughnessTexture, occlusionTexture;
    uint emissiveTexture;
    float alphaCutoff;
    uint unused0, unused1;
};

/// Follows the material's first five words, one for each texture in the order above.
struct GpuTextureTransform {
    vec4 uRow, vRow;  // u' = dot(uRow.xyz, (u, v, 1))
};

struct GpuLight {
    vec3 position;                // world
    float range;                  // 0 = no limit
    vec3 color;                   // linear, intensity multiplied in [cd]
    uint kind;                    // 1 point, 2 spot
    vec3 direction;               // the way it shines, world
    float coneScale, coneOffset;  // spot: clamp(cos·scale + offset, 0, 1)²
};

#ifdef __cplusplus
inline uint meshletTriangles(const GpuMeshlet& meshlet) {
    return meshlet.counts & 255u;
}
#else
uint meshletTriangles(GpuMeshlet meshlet) {
    return meshlet.counts & 255u;
}
uint meshletLod(GpuMeshlet meshlet) {
    return meshlet.counts >> LS_MESHLET_LOD_SHIFT;
}
#endif

LS_NAMESPACE_END

#ifdef __cplusplus
namespace lodestar::shared {
/// A material as it lies in memory.
struct GpuMaterialRecord {
    GpuMaterial material;
    GpuTextureTransform transforms[5];
};
static_assert(sizeof(GpuVertex) == 16 && sizeof(GpuVertexAttributes) == 16);
static_assert(sizeof(GpuTriangle) == 16 && sizeof(GpuMeshlet) == 48 && sizeof(GpuCluster) == 32);
static_assert(sizeof(GpuMesh) == 32 && sizeof(GpuLod) == 16 && sizeof(GpuChunk) == 32);
static_assert(sizeof(GpuDisplaced) == 32 && sizeof(GpuRefined) == 8);
static_assert(sizeof(GpuInstance) == 64 && sizeof(GpuMaterial) == 80);
static_assert(sizeof(GpuMaterialRecord) == 16 * LS_MATERIAL_WORDS);
static_assert(sizeof(GpuLight) == 52);
}  // namespace lodestar::shared
#endif
#endif
