// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One thread a cluster: 1 when its bounding sphere meets the view and its normal cone does not face
// away, else 0.
layout(local_size_x = 64) in;

layout(binding = 6, scalar) writeonly buffer Flags { uint flags[]; };
layout(push_constant, scalar) uniform Push { CullClustersParams params; };

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index > params.clusterCount) return;
    if (index == 0 || index == params.clusterCount) {  // the unused one, and the total's place
        flags[index] = 0;
        return;
    }
    const GpuCluster cluster = loadCluster(index);
    const GpuMeshlet meshlet = loadMeshlet(cluster.meshlet);
    const GpuInstance instance = loadInstance(cluster.instance);
    const vec3 centre = transformPoint(instance, meshlet.centre);
    const float radius = meshlet.radius * instance.maxScale;

    bool visible = true;
    for (int i = 0; i < 5; ++i)
        visible = visible && dot(params.planes[i], vec4(centre, 1)) >= -radius;

    // Cones hold for surfaces that are culled from behind; of others cutoff is 1 (gpu_scene.cpp).
    const uint relevant = LS_INSTANCE_CONE_VALID | LS_INSTANCE_REFLECTED;
    if (params.useCones != 0 && meshlet.coneCutoff < 1 &&
        (instance.flags & relevant) == LS_INSTANCE_CONE_VALID) {
        const vec3 axis = normalize(transformDirection(instance, meshlet.coneAxis));
        const vec3 away = centre - params.eye;
        if (dot(away, axis) >= meshlet.coneCutoff * length(away) + radius) visible = false;
    }
    flags[index] = visible ? 1 : 0;
}
