// SPDX-License-Identifier: Apache-2.0
// Rasterising in compute: what the passes of capture_compute share.
#ifndef LS_CAPTURE_COMPUTE_GLSL
#define LS_CAPTURE_COMPUTE_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#include "triangle.glsl"
#include "capture_compute_params.h"
#define LS_MATERIAL_BINDING 10
#define LS_TEXTURE_BINDING 11
#include "../scene/material.glsl"

layout(local_size_x = LS_CAPTURE_GROUP) in;

layout(constant_id = 1) const uint kMasked = 0;  // the queue of alpha-masked triangles
layout(constant_id = 2) const uint kBaseColorArrays = 255;

layout(binding = 6, scalar) buffer Words { uint64_t words[]; };  // depth << 32 | id
layout(binding = 7, scalar) buffer Counts { CaptureQueueCounts counts; };
layout(binding = 8, scalar) buffer Large { CaptureLarge large[]; };
layout(binding = 9, scalar) buffer Jobs { uvec2 jobs[]; };  // large triangle; tile x | y << 16
layout(binding = 12) uniform samplerBuffer secondUvs;
#include "alpha.glsl"
layout(binding = 13, scalar) buffer Clipped { uint clipped[]; };  // listed triangles to clip
layout(binding = 14) uniform usamplerBuffer listedIds;
layout(push_constant, scalar) uniform Push { CaptureComputeParams params; };

const int kTile = int(LS_CAPTURE_TILE);
const int kSub = 256;  // steps of a sample that vertices snap to

/// A triangle ready for its edges and depth to be evaluated anywhere.
struct Setup {
    CaptureLarge t;
    float depthX, depthY;  // change per 1/256 sample
    float least, most;     // depth of the vertices: what rounding must not leave
};

bool doubleSided(uint id) {
    return (loadCluster(id >> LS_TRIANGLE_BITS).bin & 1) != 0;  // of scene::DrawBin
}

ivec2 snapped(vec4 clip) {
    precise const vec2 at = (clip.xy / clip.w * 0.5 + 0.5) * vec2(params.size) * float(kSub);
    return ivec2(floor(at + 0.5));
}

/// Whether a triangle lies before the near plane in part (reversed depth: z > w), or beyond what the
/// integers hold. A comparison with NaN fails.
bool mustClip(vec4 a, vec4 b, vec4 c) {
    const vec3 w = vec3(a.w, b.w, c.w);
    const vec3 reach = max(abs(vec3(a.x, b.x, c.x)), abs(vec3(a.y, b.y, c.y)));
    return !(all(lessThanEqual(vec3(a.z, b.z, c.z), w)) && all(greaterThan(w, vec3(0))) &&
             all(lessThanEqual(reach, 2 * w)));
}

int64_t doubleArea(ivec2 a, ivec2 b, ivec2 c) {
    const ivec2 u = b - a, v = c - a;
    return int64_t(u.x) * v.y - int64_t(u.y) * v.x;
}

/// False for a triangle without area or seen from behind. Otherwise winds it so that its inside is
/// positive (y runs down: the front is negative).
bool makeFront(inout CaptureLarge t) {
    const int64_t area = doubleArea(t.v0, t.v1, t.v2);
    if (area < 0) {
        t = CaptureLarge(t.v0, t.v2, t.v1, t.depth.xzy, t.id);
        return true;
    }
    return area > 0 && doubleSided(t.id);
}

// Everything below is computed in the same words by every pass, and `precise`, so that a sample has
// the same depth whichever pass it falls to.
Setup makeSetup(CaptureLarge t) {
    const ivec2 u = t.v1 - t.v0, v = t.v2 - t.v0;
    precise const float perArea = 1 / float(int64_t(u.x) * v.y - int64_t(u.y) * v.x);
    precise const float d1 = t.depth.y - t.depth.x, d2 = t.depth.z - t.depth.x;
    precise const float x = (d1 * float(v.y) - d2 * float(u.y)) * perArea;
    precise const float y = (d2 * float(u.x) - d1 * float(v.x)) * perArea;
    return Setup(t, x, y, min(t.depth.x, min(t.depth.y, t.depth.z)),
                 max(t.depth.x, max(t.depth.y, t.depth.z)));
}

/// Samples whose centres can lie inside, clipped to the band: first and last.
ivec4 boxOf(CaptureLarge t) {
    const ivec2 low = min(t.v0, min(t.v1, t.v2)), high = max(t.v0, max(t.v1, t.v2));
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
    return passesAlpha(masked, clip0, clip1, clip2, (vec2(at) + 0.5) * toNdc - 1, toNdc,
                       kBaseColorArrays);
}

/// Tests the samples first … last (at most a tile a side), which lie in the band, in steps of
/// `stride` columns. None when first > last.
void rasterise(Setup s, ivec2 first, ivec2 last, int stride) {
    const ivec2 d0 = s.t.v1 - s.t.v0, d1 = s.t.v2 - s.t.v1, d2 = s.t.v0 - s.t.v2;
    ivec3 row = ivec3(edgeAt(s.t.v0, s.t.v1, first), edgeAt(s.t.v1, s.t.v2, first),
                      edgeAt(s.t.v2, s.t.v0, first));
    const ivec3 stepX = -ivec3(d0.y, d1.y, d2.y) * stride, stepY = ivec3(d0.x, d1.x, d2.x);
    ivec3 e = row;
    ivec2 at = first;
    // One loop over all samples: threads side by side then wait for the one with most samples, not
    // for the widest and the highest.
    while (at.x <= last.x && at.y <= last.y) {
        if ((e.x | e.y | e.z) >= 0 && passesAlpha(at)) {
            const vec2 to = vec2(at * kSub + kSub / 2 - s.t.v0);
            precise const float plane = s.t.depth.x + s.depthX * to.x + s.depthY * to.y;
            const float depth = clamp(plane, s.least, s.most);
            const int index = (at.y - int(params.firstRow)) * int(params.size.x) + at.x;
            atomicMax(words[index], packUint2x32(uvec2(s.t.id, floatBitsToUint(depth))));
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
bool outside(CaptureLarge t, ivec2 first, ivec2 last) {
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
bool queueLarge(CaptureLarge t) {
    const uint slot = atomicAdd(counts.large, 1);
    if (slot >= LS_CAPTURE_LARGE) return false;
    large[slot] = t;
    return true;
}

/// Rasterises a triangle of any size, or nothing when !used, in this thread alone.
void rasteriseAll(CaptureLarge t, bool used) {
    const ivec4 box = used ? boxOf(t) : ivec4(0, 0, -1, -1);
    const Setup s = makeSetup(t);
    const ivec2 tiles0 = box.xy / kTile, tiles1 = used ? box.zw / kTile : ivec2(-1);
    for (int y = tiles0.y; y <= tiles1.y; ++y)
        for (int x = tiles0.x; x <= tiles1.x; ++x)
            rasterise(s, tileFirst(ivec2(x, y), box), tileLast(ivec2(x, y), box), 1);
}

#endif
