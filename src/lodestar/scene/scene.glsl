// SPDX-License-Identifier: Apache-2.0
// The scene's geometry, bound at 0 … 5 (scene_bindings.hpp).
#ifndef LS_SCENE_GLSL
#define LS_SCENE_GLSL
#include "gpu_types.h"
#include "../shared/octahedral.h"

layout(binding = 0) uniform usamplerBuffer sceneVertices;
layout(binding = 1) uniform usamplerBuffer sceneAttributes;
layout(binding = 2) uniform usamplerBuffer sceneTriangles;
layout(binding = 3) uniform usamplerBuffer sceneMeshlets;
layout(binding = 4) uniform usamplerBuffer sceneInstances;
layout(binding = 5) uniform usamplerBuffer sceneClusters;

GpuVertex loadVertex(uint index) {
    const uvec4 w = texelFetch(sceneVertices, int(index));
    return GpuVertex(uintBitsToFloat(w.xyz), w.w);
}

GpuVertexAttributes loadAttributes(uint index) {
    const uvec4 w = texelFetch(sceneAttributes, int(index));
    return GpuVertexAttributes(uintBitsToFloat(w.xy), w.z, w.w);
}

GpuTriangle loadStoredTriangle(uint index) {
    const uvec4 w = texelFetch(sceneTriangles, int(index));
    return GpuTriangle(w.x, w.y, w.z, w.w);
}

GpuMeshlet loadMeshlet(uint index) {
    const vec4 sphere = uintBitsToFloat(texelFetch(sceneMeshlets, int(3 * index)));
    const vec4 cone = uintBitsToFloat(texelFetch(sceneMeshlets, int(3 * index + 1)));
    const uvec4 rest = texelFetch(sceneMeshlets, int(3 * index + 2));
    return GpuMeshlet(sphere.xyz, sphere.w, cone.xyz, cone.w, rest.x, rest.y, rest.z, rest.w);
}

GpuInstance loadInstance(uint index) {
    const int at = int(4 * index);
    const uvec4 last = texelFetch(sceneInstances, at + 3);
    return GpuInstance(uintBitsToFloat(texelFetch(sceneInstances, at)),
                       uintBitsToFloat(texelFetch(sceneInstances, at + 1)),
                       uintBitsToFloat(texelFetch(sceneInstances, at + 2)),
                       uintBitsToFloat(last.x), last.y, last.z, last.w);
}

GpuCluster loadCluster(uint index) {
    const uvec4 a = texelFetch(sceneClusters, int(2 * index));
    const uvec4 b = texelFetch(sceneClusters, int(2 * index + 1));
    return GpuCluster(a.x, a.y, a.z, a.w, b.x, b.y, b.z, 0);
}

vec3 transformPoint(GpuInstance instance, vec3 p) {
    const vec4 h = vec4(p, 1);
    return vec3(dot(instance.row0, h), dot(instance.row1, h), dot(instance.row2, h));
}

vec3 transformDirection(GpuInstance instance, vec3 d) {
    return vec3(dot(instance.row0.xyz, d), dot(instance.row1.xyz, d), dot(instance.row2.xyz, d));
}

/// Normals go by the cofactor matrix, which needs no inverse and survives any scale; it turns with
/// a reflection, which is undone here. Not normalised.
vec3 transformNormal(GpuInstance instance, vec3 n) {
    const vec3 a = instance.row0.xyz, b = instance.row1.xyz, c = instance.row2.xyz;
    const vec3 m = vec3(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n));
    return (instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -m : m;
}

/// Which vertex a corner (0, 1, 2) of a listed triangle is. Corners go counter-clockwise seen from
/// outside, also where the instance is a mirror image.
uint cornerVertex(GpuCluster cluster, GpuInstance instance, uint id, uint corner) {
    const GpuTriangle t = loadStoredTriangle(cluster.triangles + (id & LS_TRIANGLE_MASK));
    const bool reflected = (instance.flags & LS_INSTANCE_REFLECTED) != 0;
    if (corner == 0) return t.a;
    return (corner == 1) != reflected ? t.b : t.c;
}

#endif
