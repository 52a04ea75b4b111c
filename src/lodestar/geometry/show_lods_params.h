// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SHOW_LODS_PARAMS_H
#define LS_SHOW_LODS_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct ShowLodsParams {
    vec2 scale;  // pixels of `ids` a pixel of the picture
};

LS_NAMESPACE_END
#endif
