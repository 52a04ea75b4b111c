// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One thread a candidate: writes the record of each visible one, in order, and clears what its
// triangles will be counted in.
layout(local_size_x = LS_SPAN) in;

layout(binding = 6) uniform usamplerBuffer meshes;
layout(binding = 7, scalar) readonly buffer Counts { CullCounts counts; };
layout(binding = 8, scalar) readonly buffer Candidates { uvec2 candidates[]; };
layout(binding = 9, scalar) readonly buffer Offsets { uint offsets[]; };  // flags, scanned
layout(binding = 10, scalar) writeonly buffer Clusters { uvec4 clusters[]; };
layout(binding = 11, scalar) writeonly buffer Triangles { uint triangleCounts[]; };
layout(binding = 12, scalar) writeonly buffer Masks { uvec4 masks[]; };
layout(push_constant, scalar) uniform Push {
    PhaseParams push;
    uint totals;
};

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN,
                                    gl_LocalInvocationID.x);
    const bool second = push.phase == 1;
    if (index >= counts.lists[second ? LS_LIST_CANDIDATES_2 : LS_LIST_CANDIDATES].count) return;
    const uvec2 candidate = candidates[index];
    if ((candidate.y & LS_CANDIDATE_VISIBLE) == 0) return;
    const uint place = offsets[index] + offsets[totals + index / LS_BLOCK];
    if (place >= counts.lists[second ? LS_LIST_CLUSTERS_2 : LS_LIST_CLUSTERS].count) return;
    const uint number = push.table + place + (second ? counts.lists[LS_LIST_CLUSTERS].count : 0);

    const uint meshletIndex = candidate.y & ~LS_CANDIDATE_VISIBLE;
    const GpuMeshlet meshlet = loadMeshlet(meshletIndex);
    const uint mesh = loadInstance(candidate.x).mesh;
    const uint bin = texelFetch(meshes, int(2 * mesh + 1)).z;
    clusters[2 * number] = uvec4(candidate.x, meshletIndex, meshlet.triangles, meshlet.material);
    clusters[2 * number + 1] = uvec4(meshletTriangles(meshlet), meshletLod(meshlet), bin, 0);
    triangleCounts[place] = 0;
    masks[place] = uvec4(0);
}
