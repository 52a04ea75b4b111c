// SPDX-License-Identifier: Apache-2.0
// How often an edge is halved. Include after declaring `params` (TessellateParams).
#ifndef LS_TESSELLATE_GLSL
#define LS_TESSELLATE_GLSL

/// The eye in the space of an object.
vec3 eyeIn(GpuInstance instance) {
    const mat3 object = transpose(mat3(instance.row0.xyz, instance.row1.xyz, instance.row2.xyz));
    const vec3 origin = vec3(instance.row0.w, instance.row1.w, instance.row2.w);
    return inverse(object) * (params.eye - origin);
}

/// Whether p comes before q: both triangles of an edge must walk it the same way to agree to the bit.
bool before(vec3 p, vec3 q) {
    if (p.x != q.x) return p.x < q.x;
    return p.y != q.y ? p.y < q.y : p.z < q.z;
}

/// The least distance of the edge between p and q from the eye, a function of these alone: the same
/// in every kernel and for both of its triangles.
float edgeApart(vec3 p, vec3 q, vec3 eye) {
    const bool ordered = before(p, q);
    const vec3 low = ordered ? p : q, high = ordered ? q : p;
    precise vec3 along = high - low;
    precise vec3 from = eye - low;
    precise float squared = along.x * along.x + along.y * along.y + along.z * along.z;
    precise float t = from.x * along.x + from.y * along.y + from.z * along.z;
    t = squared > 0 ? clamp(t / squared, 0.0, 1.0) : 0.0;
    precise vec3 off = from - along * t;
    precise float apart = sqrt(off.x * off.x + off.y * off.y + off.z * off.z);
    return apart;
}

/// The reach of this frame: the first within which there is a place for all triangles; 0 when even
/// the last has more. Fewer are refined then, but never one beside a neighbour that should be.
float reachThatFits(uint within[LS_TESS_REACHES]) {
    float reach = params.reach;
    for (uint i = 0; i < LS_TESS_REACHES; ++i) {
        if (within[i] <= params.capacity) return reach;
        reach *= sqrt(0.5);
    }
    return 0;
}

#endif
