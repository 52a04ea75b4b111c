// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include <lodestar/gpu/texel_list_params.h>
#include <lodestar/gpu/buffer.hpp>

namespace lodestar::gpu {

/// Texels of a grid that the device has chosen to be worked on, one thread each. A pass that lists
/// fills the header with 0 before.
struct TexelList {
    /// For grids of `most` texels a side at most. Throws std::invalid_argument for a side above
    /// 65,536.
    TexelList(const Device& device, vk::Extent2D most, const std::string& name)
        : size(most),
          header(device, name + ": header", sizeof(shared::TexelListHeader)),
          texels(device, name, 4ull * most.width * most.height) {
        if (most.width > 65536 || most.height > 65536)
            throw std::invalid_argument("TexelList: at most 65536 texels a side");
    }

    vk::Extent2D size;
    Buffer header;  ///< shared::TexelListHeader, its first words an indirect dispatch
    Buffer texels;  ///< x | y << 16
};

}  // namespace lodestar::gpu
