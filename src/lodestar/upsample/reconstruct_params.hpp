// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/upsample/reconstruct_params.h>
#include <lodestar/upsample/upsample.hpp>

// What kernels that include reconstruct.glsl are built and called with.

namespace lodestar::upsample {

/// kDomain of a kernel.
std::uint32_t domainOf(Reconstruct);

/// kRange of a kernel: whether it looks at depth and normal of O.
bool isGuided(Reconstruct);

/// exp(−d²/2σ²) = exp2(−falloff · d²); 0 for σ = ∞. Throws std::invalid_argument, which names the
/// sigma, for σ ≤ 0.
float falloff(float sigma, const char* name);

/// Throws std::invalid_argument as Upsample::record does.
shared::ReconstructParams reconstructParams(const Upsample::Inputs&, const Sigmas&,
                                            const UpsampleOptions&);

/// Whether taps are weighted: only then can all of them be too light.
bool isBilateral(Reconstruct);

}  // namespace lodestar::upsample
