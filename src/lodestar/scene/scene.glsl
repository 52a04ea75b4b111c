// SPDX-License-Identifier: Apache-2.0
// The scene's buffers, bound at 0 … 5 by gpu scene bindings (scene_bindings.hpp).
#ifndef LS_SCENE_GLSL
#define LS_SCENE_GLSL
#include "gpu_types.h"
#include "../shared/octahedral.h"

layout(binding = 0, scalar) readonly buffer Vertices { GpuVertex sceneVertices[]; };
layout(binding = 1, scalar) readonly buffer MeshletVertices { uint sceneMeshletVertices[]; };
layout(binding = 2, scalar) readonly buffer MeshletTriangles { uint sceneMeshletTriangles[]; };
layout(binding = 3, scalar) readonly buffer Meshlets { GpuMeshlet sceneMeshlets[]; };
layout(binding = 4, scalar) readonly buffer Instances { GpuInstance sceneInstances[]; };
layout(binding = 5, scalar) readonly buffer Clusters { GpuCluster sceneClusters[]; };

vec3 transformPoint(GpuInstance instance, vec3 p) {
    const vec4 h = vec4(p, 1);
    return vec3(dot(instance.row0, h), dot(instance.row1, h), dot(instance.row2, h));
}

vec3 transformDirection(GpuInstance instance, vec3 d) {
    return vec3(dot(instance.row0.xyz, d), dot(instance.row1.xyz, d), dot(instance.row2.xyz, d));
}

/// Normals go by the cofactor matrix, which needs no inverse and survives any scale; it turns with
/// a reflection, so the result points out of the surface either way once normalised by the caller.
vec3 transformNormal(GpuInstance instance, vec3 n) {
    const vec3 a = instance.row0.xyz, b = instance.row1.xyz, c = instance.row2.xyz;
    const vec3 m = vec3(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n));
    return (instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -m : m;
}

#endif
