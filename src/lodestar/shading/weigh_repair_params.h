// SPDX-License-Identifier: Apache-2.0
#ifndef LS_WEIGH_REPAIR_PARAMS_H
#define LS_WEIGH_REPAIR_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct WeighRepairParams {
    uvec2 fullSize;  // of O
    uint terms;      // those that are repaired
};

LS_NAMESPACE_END
#endif
