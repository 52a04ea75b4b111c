// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <lodestar/gpu/buffer.hpp>
#include <lodestar/gpu/image.hpp>

namespace lodestar::gpu {

/// What one binding of a shader is. The order in a list is the binding number.
enum class Slot { storageBuffer, uniformBuffer, texelBuffer, storageImage, sampledImage };

struct SlotArray {
    Slot slot;
    std::uint32_t count = 1;
    SlotArray(Slot s, std::uint32_t n = 1) : slot(s), count(n) {}
};

/// A resource given to one binding for one dispatch or draw.
struct Binding {
    vk::DescriptorBufferInfo buffer;
    vk::BufferView texels;
    std::vector<vk::DescriptorImageInfo> images;

    Binding(const Buffer& b) : buffer{.buffer = b.vk(), .range = VK_WHOLE_SIZE} {}
    Binding(const TexelBuffer& b) : buffer{.buffer = b.buffer().vk()}, texels(b.view()) {}
    Binding(const TexelView& v) : buffer{.buffer = v.buffer()}, texels(v.view()) {}
    /// A storage image.
    Binding(const View& view);
    Binding(const Image& image) : Binding(image.view()) {}
    /// A sampled image.
    Binding(const View& view, const vk::raii::Sampler& sampler);
    /// An array of sampled images; the last one is repeated to fill the binding.
    Binding(const std::vector<View>& views, const vk::raii::Sampler& sampler);
};

/// Values of specialization constants 0, 1, 2, … (32-bit integers, bools as 0 and 1).
using Specialization = std::vector<std::uint32_t>;

/// Pipeline layout with push descriptors (set 0) and one push-constant block of ≤ 128 bytes.
struct PipelineLayout {
    PipelineLayout(const Device&, const std::vector<SlotArray>&, std::uint32_t pushBytes,
                   vk::ShaderStageFlags, const std::string& name);

    /// Throws std::invalid_argument when the number of bindings is not that of the slots.
    void push(const vk::raii::CommandBuffer&, vk::PipelineBindPoint, const std::vector<Binding>&,
              std::span<const std::byte> constants) const;

    std::string name;
    std::vector<SlotArray> slots;
    std::uint32_t pushBytes;
    vk::ShaderStageFlags stages;
    vk::raii::DescriptorSetLayout set{nullptr};
    vk::raii::PipelineLayout layout{nullptr};
};

/// A compute pipeline.
class Kernel {
public:
    Kernel(const Device&, const std::string& name, std::span<const std::uint32_t> spirv,
           const std::vector<SlotArray>& slots, std::uint32_t pushBytes = 0,
           const Specialization& constants = {});

    const PipelineLayout& layout() const { return pipelineLayout; }
    const vk::raii::Pipeline& pipeline() const { return handle; }

private:
    PipelineLayout pipelineLayout;
    vk::raii::Pipeline handle{nullptr};
};

vk::raii::ShaderModule makeShader(const Device&, std::span<const std::uint32_t> spirv,
                                  const std::string& name);

/// Vulkan's form of a Specialization; keep it alive while the pipeline is made.
struct SpecializationInfo {
    explicit SpecializationInfo(const Specialization&);
    const vk::SpecializationInfo* get() const { return entries.empty() ? nullptr : &info; }

private:
    std::vector<vk::SpecializationMapEntry> entries;
    Specialization values;
    vk::SpecializationInfo info;
};

}  // namespace lodestar::gpu
