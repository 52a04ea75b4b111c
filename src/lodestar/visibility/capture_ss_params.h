// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CAPTURE_PARAMS_H
#define LS_CAPTURE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct CaptureParams {
    mat4 clipFromWorld;
    vec2 textureScale;  // of the gradients that the alpha test reads textures by
};

LS_NAMESPACE_END
#endif
