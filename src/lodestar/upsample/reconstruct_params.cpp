// SPDX-License-Identifier: Apache-2.0
#include <lodestar/upsample/reconstruct_params.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

namespace lodestar::upsample {

std::uint32_t domainOf(Reconstruct kind) {
    switch (kind) {
        case Reconstruct::nearest:
            return shared::LS_DOMAIN_NEAREST;
        case Reconstruct::bilateral:
        case Reconstruct::bilinear:
            return shared::LS_DOMAIN_TENT;
        case Reconstruct::biquadratic:
            return shared::LS_DOMAIN_QUADRATIC;
        case Reconstruct::bicubic:
            return shared::LS_DOMAIN_CUBIC;
        case Reconstruct::gaussian:
            return shared::LS_DOMAIN_GAUSSIAN;
        case Reconstruct::nearestDepth:
            return shared::LS_DOMAIN_NEAREST_DEPTH;
    }
    throw std::invalid_argument("Reconstruct");
}

bool isGuided(Reconstruct kind) {
    return kind != Reconstruct::bilinear && kind != Reconstruct::nearest;
}

bool isBilateral(Reconstruct kind) {
    return isGuided(kind) && kind != Reconstruct::nearestDepth;
}

float falloff(float sigma, const char* name) {
    if (!(sigma > 0)) throw std::invalid_argument(std::string("Sigmas::") + name + " must be > 0");
    return std::isinf(sigma) ? 0.0f : 1.44269504f / (2 * sigma * sigma);
}

shared::ReconstructParams reconstructParams(const Upsample::Inputs& in, const Sigmas& sigmas,
                                            const UpsampleOptions& options) {
    if (!(in.rate >= 1)) throw std::invalid_argument("Upsample::Inputs::rate must be at least 1");
    if (in.size.width == 0 || in.size.height == 0 || in.size.width > in.coarse.extent.width ||
        in.size.height > in.coarse.extent.height)
        throw std::invalid_argument("Upsample::Inputs::size must be 1 … the size of coarse");
    if (!(options.leastWeight > 0 && options.leastWeight < 1))
        throw std::invalid_argument("UpsampleOptions::leastWeight must be between 0 and 1");
    if (options.repair && options.repair->size != in.depth.extent)
        throw std::invalid_argument("UpsampleOptions::repair: the list has another size");
    return {.size = {in.size.width, in.size.height},
            .inverseRate = 1 / in.rate,
            .depthFalloff = falloff(sigmas.z, "z"),
            .normalFalloff = falloff(sigmas.n, "n"),
            .unlikeAbove = -std::log2(options.leastWeight),
            .spreadAbove = options.mostSpread};
}

}  // namespace lodestar::upsample
