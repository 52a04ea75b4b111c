// SPDX-License-Identifier: Apache-2.0
// A gpu::TexelList, of which the shader declares `list` (TexelListHeader) and `texels`.
#ifndef LS_TEXEL_LIST_GLSL
#define LS_TEXEL_LIST_GLSL

uint packTexel(ivec2 texel) { return uint(texel.x) | uint(texel.y) << 16; }
ivec2 unpackTexel(uint entry) { return ivec2(entry & 0xffffu, entry >> 16); }

/// Room for `count` texels more: the place of the first.
uint reserveTexels(uint count) {
    const uint first = atomicAdd(list.listed, count);
    const uint groups = (first + count + 63) / 64;
    if (groups > (first + 63) / 64) {
        atomicMax(list.groups[0], min(groups, LS_TEXEL_LIST_ROW));
        atomicMax(list.groups[1], (groups + LS_TEXEL_LIST_ROW - 1) / LS_TEXEL_LIST_ROW);
        list.groups[2] = 1;
    }
    return first;
}

/// Which place of the list a thread of a workgroup of 64 has.
uint placeOfThread() {
    return 64 * (gl_WorkGroupID.y * LS_TEXEL_LIST_ROW + gl_WorkGroupID.x) + gl_LocalInvocationIndex;
}

#endif
