// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lodestar::post {

/// Which side of the focus blurs.
enum class CocFormula {
    both,    ///< |z − F|: the foreground blurs too, and over its edge
    thesis,  ///< z − F, as printed: what lies before the focus stays sharp
};

/// CoC = clamp(d · max(0, |z − F| − n) / (m − n), 0, 1)          (thesis, eq. 4)
struct DofOptions {
    float focus = 0;        ///< F: linear view depth that is sharp [scene units], > 0
    float sharp = 0;        ///< n: how far around it all is sharp
    float full = 1;         ///< m > n: how far from it all is blurred the most
    float degree = 1;       ///< d
    float radius = 0.012f;  ///< of the largest blur, of the picture's height; 2 σ of its Gaussian
    CocFormula formula = CocFormula::both;
};

}  // namespace lodestar::post
