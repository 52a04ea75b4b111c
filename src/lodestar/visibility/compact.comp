// SPDX-License-Identifier: Apache-2.0
#version 460
#include "compact_params.h"

// From the ids of a band of grid C to heads and nodes, one thread a pixel of grid B. Twice: the
// first run writes heads and counts nodes, the second, after the counts are summed, writes nodes.
layout(local_size_x = LS_COMPACT_GROUP) in;

layout(constant_id = 0) const uint kSide = 8;       // s: samples a side of a pixel
layout(constant_id = 1) const uint kFromBuffer = 0;  // samples lie in `words`, not in `ids`
layout(constant_id = 2) const uint kWriteNodes = 0;

layout(binding = 0) uniform usampler2D ids;
layout(binding = 1) uniform usamplerBuffer words;  // a sample: id, depth
layout(binding = 2, scalar) buffer Heads { VisibilityHead heads[]; };
layout(binding = 3, scalar) buffer Counts { uint counts[]; };  // a pixel of the band
layout(binding = 4, scalar) writeonly buffer Nodes { VisibilityNode nodes[]; };
layout(binding = 5, scalar) buffer Totals { uint totals[]; };
layout(push_constant, scalar) uniform Push { CompactVisibilityParams params; };

const uint kSamples = kSide * kSide;
const uint kNoId = 0xffffffffu;

uvec2 pixel;  // of the band

uint sampleId(uint i) {
    const uvec2 at = pixel * kSide + uvec2(i % kSide, i / kSide);
    if (kFromBuffer != 0) return texelFetch(words, int(at.y * params.width * kSide + at.x)).x;
    return texelFetch(ids, ivec2(at), 0).x;
}

uvec2 bitOf(uint i) { return i < 32 ? uvec2(1u << i, 0) : uvec2(0, 1u << (i - 32)); }

// The first four different ids of the pixel and their masks: nearly always all there are.
uvec4 slots = uvec4(kNoId), low = uvec4(0), high = uvec4(0);
uvec2 rest;  // samples with other ids

void fillSlots(bool mixed) {
    uint used = 0;
    rest = uvec2(0);
    // No iterations for a group without a mixed pixel: some drivers run both sides of a branch.
    for (uint i = 0; i < (mixed ? kSamples : 0); ++i) {
        const uint id = sampleId(i);
        const uvec2 bit = bitOf(i);
        bvec4 at = equal(slots, uvec4(id));
        if (!any(at)) {
            at = equal(uvec4(0, 1, 2, 3), uvec4(used));
            if (used < 4)
                ++used;
            else
                rest |= bit;
        }
        slots = mix(slots, uvec4(id), at);
        low |= mix(uvec4(0), uvec4(bit.x), at);
        high |= mix(uvec4(0), uvec4(bit.y), at);
    }
}

/// Takes the next id out of `rest`.
uint takeFromRest(out uvec2 mask) {
    const uint id = sampleId(rest.x != 0 ? findLSB(rest.x) : 32 + findLSB(rest.y));
    mask = uvec2(0);
    for (uint i = 0; i < kSamples; ++i)
        if (sampleId(i) == id) mask |= bitOf(i);
    rest &= ~mask;
    return id;
}

void countNodes(uint at, uint headAt) {
    const uint first = sampleId(0);
    bool mixed = false;
    for (uint i = 1; i < kSamples; ++i) mixed = mixed || sampleId(i) != first;

    uint best = first, bestCount = 0, distinct = mixed ? 0 : 1;
    fillSlots(mixed);
    for (uint i = 0; i < (mixed ? 4 : 0); ++i) {
        if (slots[i] == kNoId) continue;
        const uint n = bitCount(low[i]) + bitCount(high[i]);
        if (n > bestCount || (n == bestCount && slots[i] < best)) {
            best = slots[i];
            bestCount = n;
        }
        ++distinct;
    }
    while ((rest.x | rest.y) != 0) {
        uvec2 mask;
        const uint id = takeFromRest(mask);
        const uint n = bitCount(mask.x) + bitCount(mask.y);
        if (n > bestCount || (n == bestCount && id < best)) {
            best = id;
            bestCount = n;
        }
        ++distinct;
    }
    heads[headAt] = VisibilityHead(best, mixed ? 0 : best == 0 ? LS_LIST_EMPTY : LS_LIST_NONE);
    counts[at] = distinct - 1;
}

void writeNodes(uint at, uint headAt) {
    const uint before = totals[params.band];
    const uint begin = before + counts[at], end = before + counts[at + 1];
    const bool mixed = begin != end;
    // What does not fit is not written; the host sees the total and captures again.
    const bool fits = end <= params.capacity;
    if (mixed) heads[headAt].list = fits ? begin : LS_LIST_NONE;

    const uint representative = heads[headAt].id;
    uint to = begin;
    fillSlots(mixed && fits);
    for (uint i = 0; i < (mixed && fits ? 4 : 0); ++i) {
        if (slots[i] == kNoId || slots[i] == representative) continue;
        const uint last = to + 1 == end ? LS_LAST_NODE : 0;
        nodes[to++] = VisibilityNode(slots[i] | last, low[i], high[i]);
    }
    while ((rest.x | rest.y) != 0) {
        uvec2 mask;
        const uint id = takeFromRest(mask);
        if (id == representative) continue;
        const uint last = to + 1 == end ? LS_LAST_NODE : 0;
        nodes[to++] = VisibilityNode(id | last, mask.x, mask.y);
    }
}

void main() {
    const uint at = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * LS_COMPACT_GROUP;
    const uint pixels = params.width * params.rows;
    if (at >= pixels) {
        if (at == pixels) {
            // The band's own total, where the prefix sum wants a value and leaves the sum.
            if (kWriteNodes == 0)
                counts[at] = 0;
            else
                totals[params.band + 1] = totals[params.band] + counts[at];
        }
        return;
    }
    pixel = uvec2(at % params.width, at / params.width);
    const uint headAt = params.firstRow * params.width + at;
    if (kWriteNodes == 0)
        countNodes(at, headAt);
    else
        writeNodes(at, headAt);
}
