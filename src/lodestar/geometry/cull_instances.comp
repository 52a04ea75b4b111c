// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One thread a place for an instance in the visible chunks: is it in view, at which level of detail,
// and how many meshlets are to be looked at? The second phase asks again about what was hidden
// behind the last frame's picture.
layout(local_size_x = LS_SPAN) in;

layout(binding = 6, scalar) uniform Params { CullParams params; };
layout(binding = 7) uniform usamplerBuffer chunks;
layout(binding = 8) uniform usamplerBuffer drawOrder;
layout(binding = 9) uniform usamplerBuffer meshes;
layout(binding = 10) uniform usamplerBuffer lods;
layout(binding = 11) uniform samplerBuffer pyramid;
layout(binding = 12) uniform usamplerBuffer displaced;
layout(binding = 13) uniform usamplerBuffer refined;
layout(binding = 14, scalar) readonly buffer Visible { uint visibleChunks[]; };
layout(binding = 15, scalar) buffer Counts { CullCounts counts; };
layout(binding = 16, scalar) writeonly buffer Clusters { uint clusterCounts[]; };
layout(binding = 17, scalar) buffer States { uint states[]; };
layout(push_constant, scalar) uniform Push { PhaseParams push; };

#define LS_WITH_HIZ
#include "cull_test.glsl"

/// The level for a sphere of the view: the coarsest whose error is allowed.
uint pickLod(uint firstLod, uint lodCount, float scale, vec3 centre, float radius) {
    if (params.lodMode == LS_LOD_OFF) return 0;
    const float apart = distance(centre, params.lodEye);
    uint lod = 0;
    if (params.lodMode == LS_LOD_DISTANCE) {
        lod = uint(dot(vec4(greaterThanEqual(vec4(apart), params.distances0)), vec4(1)) +
                   dot(vec4(greaterThanEqual(vec4(apart), params.distances1)), vec4(1)));
        return min(lod, lodCount - 1);
    }
    const float nearest = params.lodParallel != 0 ? 1 : max(apart - radius, 0);
    for (uint i = 1; i < lodCount; ++i) {
        const float error = uintBitsToFloat(texelFetch(lods, int(firstLod + i)).z);
        if (error * scale * params.lodScale > nearest) break;
        lod = i;
    }
    return lod;
}

/// Those of the level, and those the instance is refined to.
uint meshletsOf(GpuInstance instance, uint lod) {
    const uint firstLod = texelFetch(meshes, int(2 * instance.mesh + 1)).x;
    const uint more =
        params.reliefReach > 0 ? texelFetch(refined, int(instance.displaced)).y : 0;
    return texelFetch(lods, int(firstLod + lod)).y + more;
}

/// Whether a part of it may be refined: only the finest level is, and its neighbours count on it.
bool isRefined(GpuInstance instance, vec3 centre, float radius) {
    const float wave = uintBitsToFloat(texelFetch(displaced, int(2 * instance.displaced)).y);
    return params.reliefReach > 0 &&
           distance(centre, params.lodEye) - radius <
               wave * instance.maxScale * params.reliefReach * 1.01;
}

void main() {
    const uint slot = linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN,
                                   gl_LocalInvocationID.x);
    if (slot >= counts.lists[LS_LIST_INSTANCES].count) return;

    if (push.phase == 1) {
        const uint state = states[slot];
        uint clusters = 0;
        // A loop of one round, which a CPU driver skips where a branch it would not.
        for (uint left = state & (LS_STATE_HIDDEN | LS_STATE_PARTLY); left != 0; left = 0) {
            const GpuInstance instance = loadInstance(state & LS_STATE_INSTANCE);
            const vec4 sphere = uintBitsToFloat(texelFetch(meshes, int(2 * instance.mesh)));
            const vec3 centre = transformPoint(instance, sphere.xyz);
            const float radius = sphere.w * instance.maxScale;
            if (!hiddenBehind(params.hizFromWorld1, centre, radius)) {
                const uint lod = (state >> LS_STATE_LOD_SHIFT) & 15u;
                clusters = meshletsOf(instance, lod);
                if ((state & LS_STATE_HIDDEN) != 0) atomicAdd(counts.instancesFound, 1);
            }
        }
        clusterCounts[slot] = clusters;
        return;
    }

    uint clusters = 0, state = 0;
    const uvec4 chunk = texelFetch(chunks, int(2 * visibleChunks[slot / LS_CHUNK] + 1));
    if (slot % LS_CHUNK < chunk.y) {
        const uint index = texelFetch(drawOrder, int(chunk.x + slot % LS_CHUNK)).x;
        const GpuInstance instance = loadInstance(index);
        const vec4 sphere = uintBitsToFloat(texelFetch(meshes, int(2 * instance.mesh)));
        const vec3 centre = transformPoint(instance, sphere.xyz);
        const float radius = sphere.w * instance.maxScale;
        if (params.mode == LS_CULL_NONE || params.listAll != 0 || inFrustum(centre, radius)) {
            const uvec4 levels = texelFetch(meshes, int(2 * instance.mesh + 1));
            const uint lod = isRefined(instance, centre, radius)
                                 ? 0
                                 : pickLod(levels.x, levels.y, instance.maxScale, centre, radius);
            state = index | lod << LS_STATE_LOD_SHIFT;
            if (params.mode == LS_CULL_HIZ && params.hizValid != 0 &&
                hiddenBehind(params.hizFromWorld0, centre, radius)) {
                state |= LS_STATE_HIDDEN;
                atomicAdd(counts.instancesHidden, 1);
            } else {
                state |= LS_STATE_DRAWN;
                clusters = meshletsOf(instance, lod);
                atomicAdd(counts.instances, 1);
            }
        }
    }
    clusterCounts[slot] = clusters;
    states[slot] = state;
}
