// SPDX-License-Identifier: Apache-2.0
// Rasterising in compute: what the passes of capture_compute share.
#ifndef LS_CAPTURE_COMPUTE_GLSL
#define LS_CAPTURE_COMPUTE_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#include "triangle.glsl"
#include "../geometry/project.glsl"
#include "capture_compute_params.h"
#define LS_MATERIAL_BINDING 6
#define LS_TEXTURE_BINDING 7
#include "../scene/material.glsl"

layout(local_size_x = LS_CAPTURE_GROUP) in;

layout(constant_id = 1) const uint kMasked = 0;  // the queue of alpha-masked triangles
layout(constant_id = 2) const uint kBaseColorArrays = 255;

layout(binding = 8) uniform samplerBuffer secondUvs;
#include "alpha.glsl"
layout(binding = 9) uniform usamplerBuffer listedIds;
layout(binding = 10) uniform usamplerBuffer projected;
layout(binding = 21) uniform samplerBuffer projectedDepths;
// What one pass writes another fetches.
layout(binding = 11) uniform usamplerBuffer wordTexels;
layout(binding = 12) uniform usamplerBuffer largeTexels;
layout(binding = 13) uniform usamplerBuffer jobTexels;
layout(binding = 14, scalar) buffer Words { uint64_t words[]; };  // depth << 32 | id
layout(binding = 15, scalar) buffer Counts { CaptureQueueCounts counts; };
layout(binding = 16, scalar) writeonly buffer Large { uvec4 large[]; };  // three a triangle
layout(binding = 17, scalar) writeonly buffer Jobs { uvec2 jobs[]; };  // large triangle, next job
layout(binding = 18, scalar) buffer Heads { uint heads[]; };  // first job of a tile, from 1 on
layout(binding = 19, scalar) buffer Touched { uint touched[]; };  // tiles with jobs
layout(binding = 20, scalar) buffer Clipped { uint clipped[]; };  // listed triangles to clip
layout(push_constant, scalar) uniform Push { CaptureComputeParams params; };

const ivec2 kTile = ivec2(LS_CAPTURE_TILE_WIDTH, LS_CAPTURE_TILE_HEIGHT);
const int kSub = int(LS_PROJECTED_STEPS);  // steps of a sample that vertices snap to

/// A triangle on the 1/256 sample grid, wound so that its inside is positive.
struct Corners {
    ivec2 v0, v1, v2;
    vec3 depth;  // z/w of the vertices
    uint id;
};

/// A triangle ready for its edges and depth to be evaluated anywhere.
struct Setup {
    ivec2 v0, v1, v2;
    uint id;
    float depth;           // of v0
    float depthX, depthY;  // change per 1/256 sample
    float least, most;     // depth of the vertices: what rounding must not leave
};

bool doubleSided(uint id) {
    return (texelFetch(sceneClusters, int(2 * (id >> LS_TRIANGLE_BITS) + 1)).z & 1) != 0;  // DrawBin
}

int64_t doubleArea(ivec2 a, ivec2 b, ivec2 c) {
    const ivec2 u = b - a, v = c - a;
    return int64_t(u.x) * v.y - int64_t(u.y) * v.x;
}

/// False for a triangle without area or seen from behind. Otherwise winds it so that its inside is
/// positive (y runs down: the front is negative).
bool makeFront(inout Corners t, bool fromBehind) {
    const int64_t area = doubleArea(t.v0, t.v1, t.v2);
    if (area < 0) {
        t = Corners(t.v0, t.v2, t.v1, t.depth.xzy, t.id);
        return true;
    }
    return area > 0 && fromBehind;
}

// Everything below is computed in the same words by every pass, and `precise`, so that a sample has
// the same depth whichever pass it falls to.
Setup makeSetup(Corners t) {
    const ivec2 u = t.v1 - t.v0, v = t.v2 - t.v0;
    precise const float perArea = 1 / float(int64_t(u.x) * v.y - int64_t(u.y) * v.x);
    precise const float d1 = t.depth.y - t.depth.x, d2 = t.depth.z - t.depth.x;
    precise const float x = (d1 * float(v.y) - d2 * float(u.y)) * perArea;
    precise const float y = (d2 * float(u.x) - d1 * float(v.x)) * perArea;
    return Setup(t.v0, t.v1, t.v2, t.id, t.depth.x, x, y,
                 min(t.depth.x, min(t.depth.y, t.depth.z)),
                 max(t.depth.x, max(t.depth.y, t.depth.z)));
}

/// Samples whose centres can lie inside, clipped to the band: first and last.
ivec4 boxOf(ivec2 v0, ivec2 v1, ivec2 v2) {
    const ivec2 low = min(v0, min(v1, v2)), high = max(v0, max(v1, v2));
    const ivec2 first = max((low + (kSub / 2 - 1)) >> 8, ivec2(0, params.firstRow));
    const ivec2 last =
        min((high - kSub / 2) >> 8, ivec2(params.size.x, params.firstRow + params.rows) - 1);
    return ivec4(first, last);
}

/// An edge function at the centre of `sample_`, in steps of a whole sample: rounding down keeps its
/// sign. Points on an edge belong to the triangle whose left or top edge it is. Clamped to what no
/// tile can step over.
int edgeAt(ivec2 a, ivec2 b, ivec2 sample_) {
    const ivec2 d = b - a, to = sample_ * kSub + kSub / 2 - a;
    const bool included = d.y < 0 || (d.y == 0 && d.x > 0);
    const int64_t e = int64_t(d.x) * to.y - int64_t(d.y) * to.x - (included ? 0 : 1);
    return int(clamp(e >> 8, int64_t(-(1 << 30)), int64_t(1 << 30)));
}

// Of the triangle being rasterised, for its alpha.
vec4 clip0, clip1, clip2;
Triangle masked;

void loadMasked(uint id) {
    if (kMasked == 0) return;
    masked = loadTriangle(id);
    clip0 = params.clipFromWorld * vec4(masked.p0, 1);
    clip1 = params.clipFromWorld * vec4(masked.p1, 1);
    clip2 = params.clipFromWorld * vec4(masked.p2, 1);
}

bool passesAlpha(ivec2 at) {
    if (kMasked == 0) return true;
    const vec2 toNdc = 2 / vec2(params.size);
    return passesAlpha(masked, clip0, clip1, clip2, (vec2(at) + 0.5) * toNdc - 1,
                       toNdc * params.textureScale, kBaseColorArrays);
}

/// Tests the samples first … last (at most 64 a side), which lie in the band, in steps of
/// `stride` columns. None when first > last.
void rasterise(Setup s, ivec2 first, ivec2 last, int stride) {
    const ivec2 d0 = s.v1 - s.v0, d1 = s.v2 - s.v1, d2 = s.v0 - s.v2;
    ivec3 row = ivec3(edgeAt(s.v0, s.v1, first), edgeAt(s.v1, s.v2, first),
                      edgeAt(s.v2, s.v0, first));
    const ivec3 stepX = -ivec3(d0.y, d1.y, d2.y) * stride, stepY = ivec3(d0.x, d1.x, d2.x);
    ivec3 e = row;
    ivec2 at = first;
    // One loop over all samples: threads side by side then wait for the one with most samples, not
    // for the widest and the highest.
    while (at.x <= last.x && at.y <= last.y) {
        if ((e.x | e.y | e.z) >= 0 && passesAlpha(at)) {
            const vec2 to = vec2(at * kSub + kSub / 2 - s.v0);
            precise const float plane = s.depth + s.depthX * to.x + s.depthY * to.y;
            const float depth = clamp(plane, s.least, s.most);
            const int index = (at.y - int(params.firstRow)) * int(params.size.x) + at.x;
            atomicMax(words[index], packUint2x32(uvec2(s.id, floatBitsToUint(depth))));
        }
        at.x += stride;
        e += stepX;
        if (at.x > last.x) {
            at = ivec2(first.x, at.y + 1);
            row += stepY;
            e = row;
        }
    }
}

/// Whether a tile lies outside one edge as a whole.
bool outside(Setup t, ivec2 first, ivec2 last) {
    for (int i = 0; i < 3; ++i) {
        const ivec2 a = i == 0 ? t.v0 : i == 1 ? t.v1 : t.v2;
        const ivec2 b = i == 0 ? t.v1 : i == 1 ? t.v2 : t.v0;
        const ivec2 inmost = ivec2(b.y - a.y < 0 ? last.x : first.x, b.x - a.x > 0 ? last.y : first.y);
        if (edgeAt(a, b, inmost) < 0) return true;
    }
    return false;
}

ivec2 tileFirst(ivec2 tile, ivec4 box) { return max(tile * kTile, box.xy); }
ivec2 tileLast(ivec2 tile, ivec4 box) { return min(tile * kTile + kTile - 1, box.zw); }

/// Queues a triangle to be cut into tiles; false when there is no room.
bool queueLarge(Setup s) {
    const uint slot = atomicAdd(counts.large, 1);
    if (slot >= LS_CAPTURE_LARGE) return false;
    large[3 * slot] = uvec4(s.v0, s.v1);
    large[3 * slot + 1] = uvec4(s.v2, s.id, floatBitsToUint(s.depth));
    large[3 * slot + 2] = floatBitsToUint(vec4(s.depthX, s.depthY, s.least, s.most));
    const uint each = LS_CAPTURE_GROUP / LS_CAPTURE_SPLITTERS;
    if (slot % each == 0)
        atomicMax(counts.splitGroups[0], min(slot / each + 1, LS_CAPTURE_MOST_GROUPS));
    return true;
}

Setup loadLarge(uint slot) {
    const uvec4 a = texelFetch(largeTexels, int(3 * slot));
    const uvec4 b = texelFetch(largeTexels, int(3 * slot + 1));
    const vec4 c = uintBitsToFloat(texelFetch(largeTexels, int(3 * slot + 2)));
    return Setup(ivec2(a.xy), ivec2(a.zw), ivec2(b.xy), b.z, uintBitsToFloat(b.w), c.x, c.y, c.z,
                 c.w);
}

/// Rasterises a triangle of any size, or nothing when !used, in this thread alone.
void rasteriseAll(Setup s, bool used) {
    const ivec4 box = used ? boxOf(s.v0, s.v1, s.v2) : ivec4(0, 0, -1, -1);
    const ivec2 tiles0 = box.xy / kTile, tiles1 = used ? box.zw / kTile : ivec2(-1);
    for (int y = tiles0.y; y <= tiles1.y; ++y)
        for (int x = tiles0.x; x <= tiles1.x; ++x)
            rasterise(s, tileFirst(ivec2(x, y), box), tileLast(ivec2(x, y), box), 1);
}

#endif
