// SPDX-License-Identifier: Apache-2.0
// What a coverage mask says. The includer has declared the specialization constant kSide: s.
#ifndef LS_COVERAGE_GLSL
#define LS_COVERAGE_GLSL

const uint kSamples = kSide * kSide;
const uvec2 kAllSamples = uvec2(kSamples >= 32 ? 0xffffffffu : (1u << (kSamples & 31)) - 1,
                                kSamples == 64 ? 0xffffffffu : 0);

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

#endif
