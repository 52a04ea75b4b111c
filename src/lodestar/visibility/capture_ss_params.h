// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CAPTURE_PARAMS_H
#define LS_CAPTURE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct CaptureParams {
    mat4 clipFromWorld;
};

LS_NAMESPACE_END
#endif
