// SPDX-License-Identifier: Apache-2.0
#version 460
#include "compact_params.h"

// From the ids of a band of grid C to heads and lists, one thread a pixel of grid B. Twice: the
// first run finds representatives and counts words, the second, after the counts are summed, writes
// the lists.
layout(local_size_x = LS_COMPACT_GROUP) in;

layout(constant_id = 0) const uint kSide = 8;       // s: samples a side of a pixel
layout(constant_id = 1) const uint kFromBuffer = 0;  // samples lie in `pairs`, not in `ids`
layout(constant_id = 2) const uint kWriteLists = 0;

layout(binding = 0) uniform usampler2D ids;
layout(binding = 1) uniform usamplerBuffer pairs;  // two samples: id, depth, id, depth
layout(binding = 2, scalar) buffer Heads { uint heads[]; };
layout(binding = 3, scalar) buffer Counts { uint counts[]; };  // words of a pixel's list
layout(binding = 4, scalar) writeonly buffer Lists { uint lists[]; };
layout(binding = 5, scalar) buffer Totals { uint totals[]; };
layout(push_constant, scalar) uniform Push { CompactVisibilityParams params; };

const uint kSamples = kSide * kSide;
const uint kMaskWords = kSide == 8 ? 2 : 1;
const uint kMostPlanes = 6;
const uint kNoId = 0xffffffffu;

uvec2 pixel;  // of the band

uint shown[kSamples];  // the ids of the pixel's samples

/// Of those in a buffer two at a time: a fetch of two costs little more than of one.
void loadShown() {
    if (kFromBuffer == 0) {
        for (uint i = 0; i < kSamples; ++i)
            shown[i] = texelFetch(ids, ivec2(pixel * kSide + uvec2(i % kSide, i / kSide)), 0).x;
        return;
    }
    for (uint i = 0; i < kSamples; i += 2) {
        const uvec2 at = pixel * kSide + uvec2(i % kSide, i / kSide);
        const uint index = at.y * params.width * kSide + at.x;  // even, but where s = 1
        const uvec4 pair = texelFetch(pairs, int(index / 2));
        shown[i] = index % 2 == 0 ? pair.x : pair.z;
        if (kSamples > 1) shown[i + 1] = pair.z;
    }
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
        const uint id = shown[i];
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
    const uint id = shown[rest.x != 0 ? findLSB(rest.x) : 32 + findLSB(rest.y)];
    mask = uvec2(0);
    for (uint i = 0; i < kSamples; ++i)
        if (shown[i] == id) mask |= bitOf(i);
    rest &= ~mask;
    return id;
}

void countWords(uint at, uint headAt) {
    loadShown();
    const uint first = shown[0];
    uint differing = 0;
    for (uint i = 1; i < kSamples; ++i) differing |= shown[i] ^ first;
    const bool mixed = differing != 0;

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
    heads[headAt] = best;
    counts[at] = mixed ? distinct + kMaskWords * (uint(findMSB(distinct - 1)) + 1) : 0;
}

// The list being written: its planes so far, and where the next id goes.
uvec2 planes[kMostPlanes];
uint number, to;

void writeId(uint id, uvec2 mask) {
    lists[to++] = id;
    for (uint i = 0; i < kMostPlanes; ++i)
        if ((number >> i & 1) != 0) planes[i] |= mask;
    ++number;
}

void writeList(uint at, uint headAt) {
    const uint before = totals[params.band];
    const uint begin = before + counts[at], end = before + counts[at + 1];
    // What does not fit is not written; the host sees the total and captures again.
    const bool writes = begin != end && end <= params.capacity;
    const uint representative = heads[headAt];
    if (writes) heads[headAt] = LS_HEAD_LIST | begin;
    for (uint i = 0; i < kMostPlanes; ++i) planes[i] = uvec2(0);
    number = 0;
    to = begin;
    if (writes) writeId(representative, uvec2(0));
    if (writes) loadShown();
    fillSlots(writes);
    uint last = 0;
    for (uint i = 0; i < (writes ? 4 : 0); ++i) {
        if (slots[i] == kNoId || slots[i] == representative) continue;
        last = slots[i];
        writeId(last, uvec2(low[i], high[i]));
    }
    while ((rest.x | rest.y) != 0) {
        uvec2 mask;
        const uint id = takeFromRest(mask);
        if (id == representative) continue;
        last = id;
        writeId(id, mask);
    }
    if (!writes) return;
    lists[to - 1] = last | LS_LAST_NODE;
    for (uint i = 0; to < end; ++i) {
        lists[to++] = planes[i].x;
        if (kMaskWords == 2) lists[to++] = planes[i].y;
    }
}

void main() {
    const uint at = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * LS_COMPACT_GROUP;
    const uint pixels = params.width * params.rows;
    if (at >= pixels) {
        if (at == pixels) {
            // The band's own total, where the prefix sum wants a value and leaves the sum.
            if (kWriteLists == 0)
                counts[at] = 0;
            else
                totals[params.band + 1] = totals[params.band] + counts[at];
        }
        return;
    }
    pixel = uvec2(at % params.width, at / params.width);
    const uint headAt = params.firstRow * params.width + at;
    if (kWriteLists == 0)
        countWords(at, headAt);
    else
        writeList(at, headAt);
}
