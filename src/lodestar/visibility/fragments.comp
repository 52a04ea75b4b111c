// SPDX-License-Identifier: Apache-2.0
#version 460
#include "triangle.glsl"
#include "fragments_params.h"
layout(constant_id = 0) const uint kSide = 8;
#define LS_HEADS_BINDING 6
#define LS_LISTS_BINDING 7
#include "record.glsl"

// The surfaces of each pixel of grid B, one thread a pixel: the triangles it lists, less those that
// continue a surface already there. The first run counts, the second writes what is to be shaded.
layout(local_size_x = 64) in;

layout(constant_id = 1) const uint kWrite = 0;

layout(binding = 8, scalar) buffer Counts { uint counts[]; };  // further fragments before a pixel
layout(binding = 9, r32ui) writeonly uniform uimage2D outIds;       // of the pixel's main surface
layout(binding = 10, rg32f) writeonly uniform image2D outPoints;    // NDC
layout(binding = 11, r32ui) writeonly uniform uimage2D outMoreIds;  // of the others
layout(binding = 12, rg32f) writeonly uniform image2D outMorePoints;
layout(binding = 13, scalar) writeonly buffer Weights { uint weights[]; };  // their samples
layout(binding = 14, scalar) buffer Merges { int merges[]; };  // by word of the lists: node → surface
layout(push_constant, scalar) uniform Push { FragmentsParams params; };

const uint kSamples = kSide * kSide;
const int kKept = 5;  // surfaces that others can continue; further ones stand alone

struct Patch {
    uint instance, material;  // of the background neither exists
    vec3 normal;              // world, at the pixel's centre
    float depth;              // there
};

/// The surface of a triangle at the centre of the pixel, or the nearest point of the triangle.
Patch patchOf(uint id, vec2 ndc) {
    if (id == 0) return Patch(0xffffffffu, 0xffffffffu, vec3(0, 0, 1), 1);
    const Triangle t = loadTriangle(id);
    const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
    const Barycentrics b =
        barycentricsAt(params.clipFromWorld * vec4(t.p0, 1), params.clipFromWorld * vec4(t.p1, 1),
                       params.clipFromWorld * vec4(t.p2, 1), ndc);
    vec3 w = max(b.at, vec3(0));
    w /= w.x + w.y + w.z;
    const vec3 normal = vertexNormal(t, w);
    const vec3 position = t.p0 * w.x + t.p1 * w.y + t.p2 * w.z;
    const float side = dot(faceNormal(t), params.eye - position) < 0 ? -1 : 1;
    return Patch(cluster.instance, cluster.material, side * normal, b.depth);
}

/// Whether shading one serves for both: one material, one orientation, no step between them.
bool continues(Patch a, Patch b) {
    return a.instance == b.instance && a.material == b.material && dot(a.normal, b.normal) > 0.98 &&
           abs(a.depth - b.depth) < 0.005 * abs(a.depth);
}

uint samplesOf(uvec2 mask) { return bitCount(mask.x) + bitCount(mask.y); }

/// The mean place of a mask's samples in the pixel, 0 … 1. Bits of a sample's number are bits of its
/// place, so counting samples by the bits of their numbers sums the places.
vec2 centroidOf(uvec2 mask) {
    const uint words[5] = {0xaaaaaaaau, 0xccccccccu, 0xf0f0f0f0u, 0xff00ff00u, 0xffff0000u};
    const uint bits = kSide == 8 ? 3 : kSide == 4 ? 2 : kSide == 2 ? 1 : 0;
    vec2 sum = vec2(0);
    for (uint i = 0; i < 2 * bits; ++i) {
        const uint n = i < 5 ? samplesOf(mask & words[i]) : bitCount(mask.y);
        if (i < bits)
            sum.x += float(n << i);
        else
            sum.y += float(n << (i - bits));
    }
    return (sum / max(float(samplesOf(mask)), 1) + 0.5) / kSide;
}

vec2 ndcOf(uvec2 pixel, vec2 inside) {
    return (vec2(pixel) + inside) / vec2(params.base) * 2 - 1;
}

void writeMore(uint slot, uvec2 pixel, uint id, uvec2 mask) {
    if (slot >= params.capacity) return;
    const ivec2 at = ivec2(slot % LS_FRAGMENT_ROW, slot / LS_FRAGMENT_ROW);
    imageStore(outMoreIds, at, uvec4(id));
    imageStore(outMorePoints, at, vec4(ndcOf(pixel, centroidOf(mask)), 0, 0));
    weights[slot] = samplesOf(mask);
}

void main() {
    const uint at = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 64;
    const uint pixels = params.base.x * params.base.y;
    if (at >= pixels) {
        if (at == pixels && kWrite == 0) counts[at] = 0;
        return;
    }
    const uvec2 pixel = uvec2(at % params.base.x, at / params.base.x);
    const Head head = loadHead(at);
    const bool mixed = head.listed;
    const vec2 centre = ndcOf(pixel, vec2(0.5));
    const uint begin = kWrite != 0 ? counts[at] : 0;

    Patch kept[kKept];
    uvec2 masks[kKept];
    uint ids[kKept];
    int used = 1;
    uint more = 0;
    ids[0] = head.id;
    uvec2 others = uvec2(0);
    for (uint i = head.list; mixed; i += kNodeWords) {
        if (kWrite == 0 && i == head.list) kept[0] = patchOf(head.id, centre);
        const Node node = loadNode(i);
        const uint id = node.id & ~LS_LAST_NODE;
        const uvec2 mask = node.mask;
        // What continues what is found once, by the first run.
        Patch own;
        int same = -1;
        if (kWrite == 0) {
            own = patchOf(id, centre);
            for (int k = used - 1; k >= 0; --k)
                if (continues(kept[k], own)) same = k;
            merges[i] = same;
        } else {
            same = merges[i];
        }
        if (same < 0) {
            if (used < kKept) {
                if (kWrite == 0) kept[used] = own;
                masks[used] = mask;
                ids[used] = id;
                ++used;
            } else if (kWrite != 0) {
                writeMore(begin + more, pixel, id, mask);
            }
            ++more;
        } else if (same > 0) {
            masks[same] |= mask;
        }
        if (same != 0) others |= mask;
        if ((node.id & LS_LAST_NODE) != 0) break;
    }
    if (kWrite == 0) {
        counts[at] = more;
        return;
    }
    for (int k = 1; k < used; ++k) writeMore(begin + uint(k - 1), pixel, ids[k], masks[k]);
    const uvec2 all = uvec2(kSamples >= 32 ? 0xffffffffu : (1u << (kSamples & 31)) - 1,
                            kSamples == 64 ? 0xffffffffu : 0);
    imageStore(outIds, ivec2(pixel), uvec4(head.id));
    imageStore(outPoints, ivec2(pixel), vec4(ndcOf(pixel, centroidOf(all & ~others)), 0, 0));
}
