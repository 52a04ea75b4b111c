// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include <lodestar/quality/image.hpp>

namespace lodestar::quality {

inline void requirePicture(const RgbImage& image, const char* name) {
    if (image.width <= 0 || image.height <= 0)
        throw std::invalid_argument(std::string(name) + ": the picture is empty");
    if (image.rgb.size() != std::size_t(3) * image.width * image.height)
        throw std::invalid_argument(std::string(name) + ": rgb must hold 3 * width * height bytes");
}

inline void requireSameSize(const RgbImage& a, const char* nameA, const RgbImage& b,
                            const char* nameB) {
    requirePicture(a, nameA);
    requirePicture(b, nameB);
    if (a.width != b.width || a.height != b.height)
        throw std::invalid_argument(std::string(nameA) + " and " + nameB + ": sizes differ");
}

}  // namespace lodestar::quality
