// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One thread a meshlet of a visible instance: 1 when its bounding sphere meets the view, its normal
// cone does not face away and nothing is known to be in front, else 0.
layout(local_size_x = LS_SPAN) in;

layout(binding = 6, scalar) uniform Params { CullParams params; };
layout(binding = 7) uniform usamplerBuffer lods;
layout(binding = 8) uniform usamplerBuffer meshes;
layout(binding = 9) uniform samplerBuffer pyramid;
layout(binding = 10) uniform usamplerBuffer offsets;       // of this phase, a slot
layout(binding = 11) uniform usamplerBuffer firstOffsets;  // of the first phase
layout(binding = 12) uniform usamplerBuffer refined;
layout(binding = 13, scalar) buffer Counts { CullCounts counts; };
layout(binding = 14, scalar) buffer States { uint states[]; };
layout(binding = 15, scalar) writeonly buffer Candidates { uvec2 candidates[]; };
layout(binding = 16, scalar) writeonly buffer Flags { uint flags[]; };
layout(binding = 17, scalar) buffer Hidden { uint hidden[]; };  // of the first phase
layout(push_constant, scalar) uniform Push {
    PhaseParams push;
    uint totals;  // where the totals of the blocks of `offsets` stand
};

#define LS_WITH_HIZ
#include "cull_test.glsl"

uint total(uint block) { return texelFetch(offsets, int(totals + block)).x; }

/// The slot a candidate is of: the last that begins at or before it.
uint slotOf(uint candidate, uint slots) {
    uint low = 0, high = (slots + LS_BLOCK - 1) / LS_BLOCK;
    while (high - low > 1) {
        const uint middle = (low + high) / 2;
        if (total(middle) <= candidate) low = middle;
        else high = middle;
    }
    const uint within = candidate - total(low);
    high = min((low + 1) * LS_BLOCK, slots);
    low *= LS_BLOCK;
    while (high - low > 1) {
        const uint middle = (low + high) / 2;
        if (texelFetch(offsets, int(middle)).x <= within) low = middle;
        else high = middle;
    }
    return low;
}

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN,
                                    gl_LocalInvocationID.x);
    const uint list = push.phase == 0 ? LS_LIST_CANDIDATES : LS_LIST_CANDIDATES_2;
    if (index >= counts.lists[list].count) return;
    const uint slot = slotOf(index, counts.lists[LS_LIST_INSTANCES].count);
    const uint own = index - total(slot / LS_BLOCK) - texelFetch(offsets, int(slot)).x;
    const uint state = states[slot];
    const uint instanceIndex = state & LS_STATE_INSTANCE;
    const GpuInstance instance = loadInstance(instanceIndex);
    const uint lod = (state >> LS_STATE_LOD_SHIFT) & 15u;
    const uint firstLod = texelFetch(meshes, int(2 * instance.mesh + 1)).x;
    const uvec2 level = texelFetch(lods, int(firstLod + lod)).xy;
    const uint beyond = texelFetch(refined, int(instance.displaced)).x + own - level.y;
    const uint meshletIndex = own < level.y ? level.x + own : beyond;

    const GpuMeshlet meshlet = loadMeshlet(meshletIndex);
    const vec3 centre = transformPoint(instance, meshlet.centre);
    const float radius = meshlet.radius * instance.maxScale;
    const bool all = params.mode == LS_CULL_NONE || params.listAll != 0;
    bool visible = all || inFrustum(centre, radius);

    // Cones hold for surfaces that are culled from behind; of others cutoff is 1 (gpu_scene.cpp).
    const uint relevant = LS_INSTANCE_CONE_VALID | LS_INSTANCE_REFLECTED;
    if (!all && params.useCones != 0 && meshlet.coneCutoff < 1 &&
        (instance.flags & relevant) == LS_INSTANCE_CONE_VALID) {
        const vec3 axis = normalize(transformDirection(instance, meshlet.coneAxis));
        const vec3 away = centre - params.eye;
        if (dot(away, axis) >= meshlet.coneCutoff * length(away) + radius) visible = false;
    }

    if (params.mode == LS_CULL_HIZ) {
        if (push.phase == 0) {
            const bool behind = visible && params.hizValid != 0 &&
                                hiddenBehind(params.hizFromWorld0, centre, radius);
            hidden[index] = behind ? 1 : 0;
            if (behind) {
                visible = false;
                atomicOr(states[slot], LS_STATE_PARTLY);
                atomicAdd(counts.clustersHidden, 1);
            }
        } else {
            if ((state & LS_STATE_DRAWN) != 0) {
                const uint first = texelFetch(firstOffsets, int(slot)).x +
                                   texelFetch(firstOffsets, int(totals + slot / LS_BLOCK)).x + own;
                if (first >= counts.lists[LS_LIST_CANDIDATES].count || hidden[first] == 0)
                    visible = false;  // was drawn, or was out of view
            }
            if (visible && hiddenBehind(params.hizFromWorld1, centre, radius)) visible = false;
        }
    }
    candidates[index] = uvec2(instanceIndex, meshletIndex | (visible ? LS_CANDIDATE_VISIBLE : 0));
    flags[index] = visible ? 1 : 0;
}
