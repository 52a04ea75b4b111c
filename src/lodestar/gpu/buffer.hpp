// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include <lodestar/gpu/device.hpp>

namespace lodestar::gpu {

enum class Residence {
    device,  ///< device memory, filled by commands or upload()
    mapped,  ///< host-visible and coherent, mapped for its whole life
};

/// A buffer with its own memory, usable for everything lodestar does with buffers.
class Buffer {
public:
    /// A size of 0 becomes 16 bytes, so that empty scenes need no special case.
    Buffer(const Device&, std::string name, std::uint64_t bytes, Residence = Residence::device);
    ~Buffer();
    Buffer(Buffer&&) = default;
    Buffer& operator=(Buffer&&);

    vk::Buffer vk() const { return *buffer; }
    std::uint64_t bytes() const { return size; }

    /// Start of a mapped buffer; null for device buffers.
    template <typename T = std::byte>
    T* mapped() const {
        return static_cast<T*>(pointer);
    }

    /// Copies `data` to the start and waits. For set-up, not for frames. Throws
    /// std::invalid_argument when it does not fit.
    void upload(std::span<const std::byte> data);
    template <typename T>
    void upload(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        upload(std::as_bytes(std::span(values)));
    }

private:
    const Device* device;
    vk::raii::DeviceMemory memory{nullptr};
    vk::raii::Buffer buffer{nullptr};
    std::uint64_t size = 0;
    void* pointer = nullptr;
};

/// A device buffer of `values` that shaders read with texelFetch, a `format` at a time. On a CPU
/// driver one fetch of four words is many times cheaper than four loads from a storage buffer.
class TexelBuffer {
public:
    /// Throws DeviceError when the device's texel buffers do not hold that many.
    TexelBuffer(const Device&, std::string name, std::uint64_t bytes, vk::Format format);

    const Buffer& buffer() const { return storage; }
    Buffer& buffer() { return storage; }
    vk::BufferView view() const { return *texels; }

private:
    Buffer storage;
    vk::raii::BufferView texels;
};

/// The same buffer by another format, of whole texels.
class TexelView {
public:
    TexelView(const Device&, const TexelBuffer& of, vk::Format format);

    vk::Buffer buffer() const { return storage; }
    vk::BufferView view() const { return *texels; }

private:
    vk::Buffer storage;
    vk::raii::BufferView texels;
};

/// A device buffer that holds `values`.
template <typename T>
Buffer makeBuffer(const Device& device, std::string name, const std::vector<T>& values) {
    Buffer buffer(device, std::move(name), values.size() * sizeof(T));
    buffer.upload(values);
    return buffer;
}

template <typename T>
TexelBuffer makeTexelBuffer(const Device& device, std::string name, const std::vector<T>& values,
                            vk::Format format) {
    TexelBuffer buffer(device, std::move(name), values.size() * sizeof(T), format);
    buffer.buffer().upload(values);
    return buffer;
}

}  // namespace lodestar::gpu
