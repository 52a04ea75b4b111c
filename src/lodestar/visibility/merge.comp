// SPDX-License-Identifier: Apache-2.0
#version 460
#include "triangle.glsl"
#include "fragments_params.h"
#include "view_params.h"
layout(constant_id = 0) const uint kSide = 8;
#define LS_HEADS_BINDING 6
#define LS_LISTS_BINDING 7
#include "record.glsl"

// Blends the surfaces of each mixed pixel by their samples. A triangle that continues the surface of
// main fragments nearby, of this pixel or its neighbours, takes their radiance; what is left is
// listed, to be shaded as further fragments.
layout(local_size_x = 64) in;

layout(binding = 8, scalar) uniform View { ViewParams view; };
layout(binding = 9) uniform usampler2D mainIds;
layout(binding = 10) uniform sampler2D mainDepth;
layout(binding = 11) uniform usampler2D mainNormal;  // view space
layout(binding = 12) uniform sampler2D mainRadiance;
layout(binding = 13, scalar) buffer Counts { FragmentCounts counts; };
layout(binding = 14, scalar) readonly buffer Mixed { uint mixed[]; };
layout(binding = 15, rgba16f) writeonly uniform image2D outRadiance;
layout(binding = 16, r32ui) writeonly uniform uimage2D outMoreIds;
layout(binding = 17, rg32f) writeonly uniform image2D outMorePoints;
layout(binding = 18, scalar) writeonly buffer Weights { uint weights[]; };  // samples
layout(binding = 19, scalar) writeonly buffer Further { FurtherPixel further[]; };
layout(push_constant, scalar) uniform Push { FragmentsParams params; };

const float kLikeNormal = 0.98;  // cosine: 11°
const float kLikeDepth = 0.005;  // of the depth
const float kReach = 1.25;       // of the tent, in pixels

/// Instance and material: what never changes along one surface.
uvec2 surfaceOf(uint id) {
    return id == 0 ? uvec2(0xffffffffu)
                   : texelFetch(sceneClusters, int(2 * (id >> LS_TRIANGLE_BITS))).xw;
}

/// A triangle's surface about a point of it.
struct Patch {
    uvec2 surface;
    vec3 normal;  // view space
    float depth;
    vec2 slope;  // of the depth, a pixel
};

Patch patchOf(uint id, vec2 ndc) {
    const Triangle t = loadTriangle(id);
    const vec4 clip0 = view.clipFromWorld * vec4(t.p0, 1), clip1 = view.clipFromWorld * vec4(t.p1, 1),
               clip2 = view.clipFromWorld * vec4(t.p2, 1);
    const Barycentrics b = barycentricsAt(clip0, clip1, clip2, ndc);
    const vec3 w = vec3(clip0.w, clip1.w, clip2.w);
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const float side = dot(faceNormal(t), view.eye - position) < 0 ? -1 : 1;
    return Patch(surfaceOf(id), side * (mat3(view.viewFromWorld) * vertexNormal(t, b.at)), b.depth,
                 vec2(dot(b.dx, w), dot(b.dy, w)) * 2 / vec2(params.base));
}

/// The radiance of the main fragments that `own` continues, about `place` [pixels], times their
/// weights; and the sum of those.
void borrow(Patch own, vec2 place, out vec4 sum, out float total) {
    sum = vec4(0);
    total = 0;
    const bool background = own.surface.x == 0xffffffffu;
    for (int i = 0; i < 9; ++i) {
        const ivec2 pixel = ivec2(place) + ivec2(i % 3, i / 3) - 1;
        const bool inside =
            all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(params.base)));
        const ivec2 from = clamp(pixel, ivec2(0), ivec2(params.base) - 1);
        const vec2 apart = vec2(pixel) + 0.5 - place;
        const vec2 tent = max(kReach - abs(apart), 0);
        const bool same =
            inside && own.surface == surfaceOf(texelFetch(mainIds, from, 0).x);
        const vec3 normal = unpackNormal(texelFetch(mainNormal, from, 0).x);
        // On the plane of the triangle the other would be as deep as this.
        const float expected = own.depth + dot(own.slope, apart);
        const float allowed = kLikeDepth * own.depth + 0.5 * (abs(own.slope.x) + abs(own.slope.y));
        const bool alike = dot(own.normal, normal) > kLikeNormal &&
                           abs(texelFetch(mainDepth, from, 0).x - expected) < allowed;
        const float weight = same && (alike || background) ? tent.x * tent.y : 0;
        sum += weight * texelFetch(mainRadiance, from, 0);
        total += weight;
    }
}

vec2 ndcOf(vec2 place) { return place / vec2(params.base) * 2 - 1; }

void blend(uint at) {
    const ivec2 pixel = ivec2(at % params.base.x, at / params.base.x);
    const List list = loadList(loadHead(at));
    // The main fragment has the first mask.
    vec4 sum = float(samplesOf(listedMask(list, 0))) * texelFetch(mainRadiance, pixel, 0);
    uvec2 left = uvec2(0);  // ids to be shaded, by their number
    for (uint k = 1; k < list.count; ++k) {
        const uvec2 mask = listedMask(list, k);
        const vec2 place = vec2(pixel) + centroidOf(mask);
        vec4 radiance;
        float total;
        const float samples = float(samplesOf(mask));
        borrow(patchOf(listedId(list, k), ndcOf(place)), place, radiance, total);
        const bool found = total > 0;
        sum += found ? radiance * (samples / total) : vec4(0);
        if (!found) left |= k < 32 ? uvec2(1u << k, 0) : uvec2(0, 1u << (k - 32));
    }
    imageStore(outRadiance, pixel, sum / kSamples);

    const uint count = samplesOf(left);
    if (count == 0) return;
    uint slot = atomicAdd(counts.further, count);
    const uint entry = atomicAdd(counts.pixels, 1);
    // What does not fit is not written; the host sees the count and makes room.
    if (max(slot + count, entry + 1) > params.capacity) return;
    further[entry] = FurtherPixel(at, slot, count);
    for (uint k = 0; (left.x | left.y) != 0; ++k) {
        if ((left.x & 1) != 0) {
            const uvec2 mask = listedMask(list, k);
            const ivec2 to = ivec2(slot % LS_FRAGMENT_ROW, slot / LS_FRAGMENT_ROW);
            imageStore(outMoreIds, to, uvec4(listedId(list, k)));
            imageStore(outMorePoints, to, vec4(ndcOf(vec2(pixel) + centroidOf(mask)), 0, 0));
            weights[slot++] = samplesOf(mask);
        }
        left = uvec2(left.x >> 1 | left.y << 31, left.y >> 1);
    }
}

void main() {
    for (uint i = gl_GlobalInvocationID.x; i < counts.mixed; i += LS_MERGE_GROUPS * 64)
        blend(mixed[i]);
}
