// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_ms_params.h"
#include "triangle.glsl"
#define LS_MATERIAL_BINDING 7
#define LS_TEXTURE_BINDING 8
#include "../scene/material.glsl"

// As capture_ss.frag, into a multisampled target. Integer ones are missing on some drivers, so the
// id goes into four unorm bytes, which is exact. Masked surfaces run once a sample; drivers differ
// in where they interpolate then, so the point is found by its sample's number.

layout(constant_id = 1) const uint kMasked = 0;
layout(constant_id = 2) const uint kSide = 4;     // samples a side of a pixel of the target
layout(constant_id = 3) const uint kSamples = 4;  // a pixel of the target
layout(constant_id = 4) const uint kBaseColorArrays = 255;

layout(binding = 9) uniform samplerBuffer secondUvs;
#include "alpha.glsl"
layout(push_constant, scalar) uniform Push { CaptureMsDrawParams params; };

layout(location = 0) flat in uint id;
layout(location = 0) out vec4 outId;

void main() {
    if (kMasked != 0) {
        const Triangle t = loadTriangle(id);
        const vec2 toNdc = 2 / params.size;
        const vec2 at = floor(gl_FragCoord.xy) + sampleLocation(gl_SampleID, kSamples) +
                        vec2(0, params.firstRow);
        if (!passesAlpha(t, params.clipFromWorld * vec4(t.p0, 1),
                         params.clipFromWorld * vec4(t.p1, 1),
                         params.clipFromWorld * vec4(t.p2, 1), at * toNdc - 1, toNdc / kSide,
                         kBaseColorArrays))
            discard;
    }
    outId = unpackUnorm4x8(id);
}
