// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/buffer.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <lodestar/gpu/image.hpp>

namespace lodestar::gpu {
namespace {

vk::raii::BufferView viewOf(const Device& device, vk::Buffer buffer, vk::Format format) {
    return {device.vk(),
            vk::BufferViewCreateInfo{.buffer = buffer, .format = format, .range = VK_WHOLE_SIZE}};
}

}  // namespace

Buffer::Buffer(const Device& owner, std::string name, std::uint64_t bytes, Residence residence)
    : device(&owner), size(std::max<std::uint64_t>(bytes, 16)) {
    using Usage = vk::BufferUsageFlagBits;
    buffer = vk::raii::Buffer(
        owner.vk(),
        vk::BufferCreateInfo{.size = size,
                             .usage = Usage::eStorageBuffer | Usage::eUniformBuffer |
                                      Usage::eUniformTexelBuffer | Usage::eIndirectBuffer |
                                      Usage::eTransferSrc | Usage::eTransferDst});
    using Memory = vk::MemoryPropertyFlagBits;
    const bool map = residence == Residence::mapped;
    const vk::MemoryPropertyFlags flags =
        map ? Memory::eHostVisible | Memory::eHostCoherent : Memory::eDeviceLocal;
    memory = owner.allocate(buffer.getMemoryRequirements(), flags, name);
    buffer.bindMemory(*memory, 0);
    owner.name(buffer, name);
    if (map) pointer = memory.mapMemory(0, VK_WHOLE_SIZE);
}

Buffer::~Buffer() {
    if (*memory) device->release(memory);
}

Buffer& Buffer::operator=(Buffer&& other) {
    if (*memory) device->release(memory);
    device = other.device;
    buffer = std::move(other.buffer);
    memory = std::move(other.memory);
    size = other.size;
    pointer = other.pointer;
    return *this;
}

void Buffer::upload(std::span<const std::byte> data) {
    if (data.size() > size) throw std::invalid_argument("Buffer::upload: data larger than buffer");
    if (data.empty()) return;
    if (pointer) {
        std::memcpy(pointer, data.data(), data.size());
        return;
    }
    const Buffer staging(*device, "upload", data.size(), Residence::mapped);
    std::memcpy(staging.pointer, data.data(), data.size());
    device->runNow([&](const vk::raii::CommandBuffer& commands) {
        commands.copyBuffer(staging.vk(), vk(), vk::BufferCopy{.size = data.size()});
    });
}

TexelBuffer::TexelBuffer(const Device& device, std::string name, std::uint64_t bytes,
                         vk::Format format)
    : storage(device, name, bytes), texels(nullptr) {
    const std::uint64_t count = storage.bytes() / texelBytes(format);
    const std::uint64_t limit = device.physical().getProperties().limits.maxTexelBufferElements;
    if (count > limit)
        throw DeviceError(fmt::format("'{}' has {} entries, {} takes {}; use a smaller scene", name,
                                      count, device.description().name, limit));
    texels = viewOf(device, storage.vk(), format);
    device.name(texels, name);
}

TexelView::TexelView(const Device& device, const TexelBuffer& of, vk::Format format)
    : storage(of.buffer().vk()), texels(viewOf(device, storage, format)) {}

}  // namespace lodestar::gpu
