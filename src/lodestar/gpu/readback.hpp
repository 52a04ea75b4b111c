// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <lodestar/gpu/buffer.hpp>
#include <lodestar/gpu/image.hpp>

namespace lodestar::gpu {

/// Level 0 of the view, rows from the top, packed. Waits for the device: for results and tests.
std::vector<std::byte> readImage(const Device&, const View&, std::uint32_t layer = 0);
/// The first `bytes` of a buffer. Waits for the device.
std::vector<std::byte> readBuffer(const Device&, const Buffer&, std::uint64_t bytes);

/// Fills one level of the view, in all layers, with packed texels. Waits for the device.
void uploadImage(const Device&, const View&, std::uint32_t level, std::span<const std::byte>);

template <typename T>
std::vector<T> as(const std::vector<std::byte>& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

}  // namespace lodestar::gpu
