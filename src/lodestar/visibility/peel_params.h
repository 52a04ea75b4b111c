// SPDX-License-Identifier: Apache-2.0
#ifndef LS_PEEL_PARAMS_H
#define LS_PEEL_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_PEELS = 4u;  // blended surfaces that a pixel may show, one behind the other

/// Begins as CaptureParams does: the vertex shader is the same.
struct PeelParams {
    mat4 clipFromWorld;
    vec2 textureScale;
    vec2 toOpaque;     // pixels of the opaque picture in one of this
    uvec2 opaqueSize;  // the part of it in use
};

LS_NAMESPACE_END
#endif
