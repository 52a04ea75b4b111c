// SPDX-License-Identifier: Apache-2.0
#ifndef LS_TEXEL_LIST_PARAMS_H
#define LS_TEXEL_LIST_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_TEXEL_LIST_ROW = 32768u;  // workgroups along x: more go on in y

struct TexelListHeader {
    uint groups[3];  // of 64 threads: an indirect dispatch
    uint listed;
};

LS_NAMESPACE_END
#endif
