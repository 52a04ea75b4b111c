// SPDX-License-Identifier: Apache-2.0
#ifndef LS_TEMPORAL_PARAMS_H
#define LS_TEMPORAL_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct TemporalParams {
    vec2 texelSize;  // 1 / size of the whole source
    vec2 last;       // where the last texel of the live part may be read [texels]
    vec2 live;       // size of the live part [texels]
    vec2 jitter;     // by which the picture was moved [texels]
    uvec2 size;      // of the output
    float falloff;   // of the kernel: log2(e) / (2 σ²), σ in pixels of the output
    float memory;    // most weight that the history may have
    uint known;      // there is a history
    uint moved;      // the camera or an instance moved since the last frame
    uint layered;    // there is a blended layer
};

/// The source's mode: this frame and the one before.
struct TemporalSourceParams {
    vec2 texelSize, last, live, jitter;  // of this frame, as above
    vec2 lastBefore, liveBefore, jitterBefore;
    uvec2 size;  // of the output
    float k;     // share of the frame before that a pixel of motion takes away
    uint known;
    uint layered;  // there is a blended layer, and something moved
};

struct TemporalShowParams {
    uvec2 size;
    float sharpness;
};

LS_NAMESPACE_END
#endif
