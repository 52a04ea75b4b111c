// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "tessellate_params.h"

// One workgroup a refined triangle, one thread a vertex and a triangle of the meshlet that stands for
// it. Vertices of an edge are functions of its ends and the eye alone, in both of its triangles: no
// cracks.
layout(local_size_x = LS_TESS_TRIANGLES) in;

layout(binding = 6, scalar) uniform Params { TessellateParams params; };
layout(binding = 7) uniform usamplerBuffer displaced;
layout(binding = 8) uniform usamplerBuffer pairs;
layout(binding = 9) uniform samplerBuffer secondUvs;
layout(binding = 10, scalar) readonly buffer Header { TessellateHeader header; };
layout(binding = 11, scalar) readonly buffer Entries { uvec2 entries[]; };
layout(binding = 12, scalar) writeonly buffer Vertices { uvec4 vertices[]; };
layout(binding = 13, scalar) writeonly buffer Attributes { uvec4 attributes[]; };
layout(binding = 14, scalar) writeonly buffer SecondUvs { vec2 newSecondUvs[]; };
layout(binding = 15, scalar) writeonly buffer Triangles { uvec4 triangles[]; };
layout(binding = 16, scalar) writeonly buffer Meshlets { uvec4 meshlets[]; };

#include "tessellate.glsl"

struct Corner {
    vec3 position, normal;
    vec4 tangent, color;
    vec2 uv, secondUv;
};

Corner cornerOf(uint vertex) {
    const GpuVertex v = loadVertex(vertex);
    const GpuVertexAttributes a = loadAttributes(vertex);
    return Corner(v.position, unpackNormal(v.normal), unpackTangent(a.tangent),
                  unpackUnorm4x8(a.color), a.uv,
                  params.secondUvs != 0 ? texelFetch(secondUvs, int(vertex)).xy : vec2(0));
}

Corner blend(Corner p, Corner q, float t) {
    precise vec3 position = p.position + (q.position - p.position) * t;
    precise vec3 normal = p.normal + (q.normal - p.normal) * t;
    if (t >= 1) {  // rounding must not move the end
        position = q.position;
        normal = q.normal;
    }
    return Corner(position, normal, vec4(mix(p.tangent.xyz, q.tangent.xyz, t), p.tangent.w),
                  mix(p.color, q.color, t), mix(p.uv, q.uv, t), mix(p.secondUv, q.secondUv, t));
}

/// The point of an edge that is `step` of 2^most ones from p, moved to the nearest of those that both of
/// its triangles have.
Corner onEdge(Corner p, Corner q, uint step, uint own, uint most) {
    const uint coarse = most - own;
    const uint at = ((step + ((1u << coarse) >> 1)) >> coarse) << coarse;
    const bool ordered = before(p.position, q.position);
    const Corner low = ordered ? p : q, high = ordered ? q : p;
    // Multiplied by a power of two: divisions need not be exact.
    return blend(low, high,
                 float(ordered ? at : (1u << most) - at) * uintBitsToFloat((127u - most) << 23));
}

uint vertexAt(uint row, uint column) { return row * (row + 1) / 2 + column; }

void main() {
    const uint place = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x;
    const uvec2 entry = entries[place];
    const uvec2 pair = texelFetch(pairs, int(entry.x)).xy;
    const uvec4 relief = texelFetch(displaced, int(2 * pair.x));
    const GpuInstance instance = loadInstance(relief.w);
    const float amplitude = uintBitsToFloat(relief.x), wavelength = uintBitsToFloat(relief.y);
    const float begins = wavelength * reachThatFits(header.within);
    const vec3 eye = eyeIn(instance);

    const GpuMeshlet meshlet = loadMeshlet(pair.y);
    const GpuTriangle triangle = loadStoredTriangle(meshlet.triangles + entry.y);
    const Corner a = cornerOf(triangle.a), b = cornerOf(triangle.b), c = cornerOf(triangle.c);
    const uint ab = divisionsAt(edgeApart(a.position, b.position, eye), begins);
    const uint bc = divisionsAt(edgeApart(b.position, c.position, eye), begins);
    const uint ca = divisionsAt(edgeApart(c.position, a.position, eye), begins);
    const uint most = max(ab, max(bc, ca)), side = 1u << most;

    // Rows from a (one vertex) to the edge from b to c (side + 1 of them).
    const uint firstVertex = params.firstVertex + place * LS_TESS_VERTICES;
    uint row = uint(0.5 * (sqrt(8.0 * float(thread) + 1.0) - 1.0));
    row += vertexAt(row + 1, 0) <= thread ? 1 : 0;
    row -= vertexAt(row, 0) > thread ? 1 : 0;
    const uint column = thread - vertexAt(row, 0);
    if (row <= side) {
        Corner v;
        if (column == 0) v = onEdge(a, b, row, ab, most);
        else if (column == row) v = onEdge(a, c, row, ca, most);
        else if (row == side) v = onEdge(b, c, column, bc, most);
        else v = blend(blend(a, b, float(row) / float(side)), blend(a, c, float(row) / float(side)),
                       float(column) / float(row));
        const vec3 normal = normalize(v.normal);
        const vec4 lift = displacementAt(v.position, amplitude, wavelength, relief.z,
                                         distance(v.position, eye), begins);
        const vec3 tilted = normalize(normal - (lift.xyz - normal * dot(normal, lift.xyz)));
        const uint at = firstVertex + thread;
        vertices[at] = uvec4(floatBitsToUint(v.position + normal * lift.w), packNormal(tilted));
        attributes[at] =
            uvec4(floatBitsToUint(v.uv), packTangent(vec4(normalize(v.tangent.xyz), v.tangent.w)),
                  packUnorm4x8(v.color));
        if (params.secondUvs != 0) newSecondUvs[at] = v.secondUv;
    }

    // Triangle number k of a row points up where k is even.
    const uint firstTriangle = params.firstTriangle + place * LS_TESS_TRIANGLES;
    if (thread < side * side) {
        uint above = uint(sqrt(float(thread)));
        above += (above + 1) * (above + 1) <= thread ? 1 : 0;
        above -= above * above > thread ? 1 : 0;
        const uint k = thread - above * above, m = k / 2;
        const bool up = (k & 1) == 0;
        const uint first = vertexAt(above, m);
        const uint second = vertexAt(above + 1, up ? m : m + 1);
        const uint third = up ? vertexAt(above + 1, m + 1) : vertexAt(above, m + 1);
        triangles[firstTriangle + thread] =
            uvec4(firstVertex + uvec3(first, second, third), first | second << 8 | third << 16);
    }

    if (thread == 0) {
        const vec3 centre = (a.position + b.position + c.position) / 3;
        const float reach =
            max(distance(centre, a.position),
                max(distance(centre, b.position), distance(centre, c.position)));
        const uint at = 3 * (params.firstMeshlet + place);
        meshlets[at] = uvec4(floatBitsToUint(vec4(centre, reach * 1.00001 + amplitude)));
        meshlets[at + 1] = uvec4(floatBitsToUint(vec4(0, 0, 1, 1)));  // no cone
        meshlets[at + 2] = 
            uvec4(firstTriangle, params.firstListed + place * LS_TESS_VERTICES, meshlet.material,
                  side * side | vertexAt(side + 1, 0) << LS_MESHLET_VERTICES_SHIFT |
                      LS_LOD_REFINED << LS_MESHLET_LOD_SHIFT);
    }
}
