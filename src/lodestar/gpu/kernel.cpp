// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/kernel.hpp>

#include <fmt/format.h>

namespace lodestar::gpu {
namespace {

vk::DescriptorType descriptorType(Slot slot) {
    switch (slot) {
        case Slot::storageBuffer:
            return vk::DescriptorType::eStorageBuffer;
        case Slot::uniformBuffer:
            return vk::DescriptorType::eUniformBuffer;
        case Slot::texelBuffer:
            return vk::DescriptorType::eUniformTexelBuffer;
        case Slot::storageImage:
            return vk::DescriptorType::eStorageImage;
        case Slot::sampledImage:
            return vk::DescriptorType::eCombinedImageSampler;
    }
    throw std::invalid_argument("Slot");
}

}  // namespace

Binding::Binding(const View& view)
    : images{{.imageView = view.view, .imageLayout = vk::ImageLayout::eGeneral}} {}

Binding::Binding(const View& view, const vk::raii::Sampler& sampler)
    : images{{.sampler = *sampler,
              .imageView = view.view,
              .imageLayout = vk::ImageLayout::eGeneral}} {}

Binding::Binding(const std::vector<View>& views, const vk::raii::Sampler& sampler) {
    for (const View& view : views) images.push_back(Binding(view, sampler).images.front());
}

PipelineLayout::PipelineLayout(const Device& device, const std::vector<SlotArray>& slotArrays,
                               std::uint32_t bytes, vk::ShaderStageFlags shaderStages,
                               const std::string& label)
    : name(label), slots(slotArrays), pushBytes(bytes), stages(shaderStages) {
    if (bytes > 128) throw std::invalid_argument(label + ": more than 128 B of push constants");
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (const SlotArray& slot : slots)
        bindings.push_back({.binding = static_cast<std::uint32_t>(bindings.size()),
                            .descriptorType = descriptorType(slot.slot),
                            .descriptorCount = slot.count,
                            .stageFlags = stages});
    set = vk::raii::DescriptorSetLayout(
        device.vk(), vk::DescriptorSetLayoutCreateInfo{
                         .flags = vk::DescriptorSetLayoutCreateFlagBits::ePushDescriptorKHR,
                         .bindingCount = static_cast<std::uint32_t>(bindings.size()),
                         .pBindings = bindings.data()});
    const vk::PushConstantRange range{.stageFlags = stages, .size = bytes};
    const vk::DescriptorSetLayout setHandle = *set;
    layout = vk::raii::PipelineLayout(
        device.vk(), vk::PipelineLayoutCreateInfo{.setLayoutCount = 1,
                                                  .pSetLayouts = &setHandle,
                                                  .pushConstantRangeCount = bytes > 0 ? 1u : 0u,
                                                  .pPushConstantRanges = &range});
    device.name(set, name);
    device.name(layout, name);
}

void PipelineLayout::push(const vk::raii::CommandBuffer& commands, vk::PipelineBindPoint point,
                          const std::vector<Binding>& bindings,
                          std::span<const std::byte> constants) const {
    if (bindings.size() != slots.size())
        throw std::invalid_argument(
            fmt::format("{}: {} bindings for {} slots", name, bindings.size(), slots.size()));
    if (constants.size() != pushBytes)
        throw std::invalid_argument(
            fmt::format("{}: {} B of push constants, not {}", name, constants.size(), pushBytes));
    std::vector<vk::WriteDescriptorSet> writes;
    std::vector<std::vector<vk::DescriptorImageInfo>> images(bindings.size());
    for (std::uint32_t i = 0; i < bindings.size(); ++i) {
        images[i] = bindings[i].images;
        if (!images[i].empty()) images[i].resize(slots[i].count, images[i].back());
        writes.push_back({.dstBinding = i,
                          .descriptorCount = slots[i].count,
                          .descriptorType = descriptorType(slots[i].slot),
                          .pImageInfo = images[i].data(),
                          .pBufferInfo = &bindings[i].buffer,
                          .pTexelBufferView = &bindings[i].texels});
    }
    commands.pushDescriptorSetKHR(point, *layout, 0, writes);
    if (!constants.empty())
        commands.pushConstants<std::byte>(
            *layout, stages, 0,
            vk::ArrayProxy<const std::byte>(static_cast<std::uint32_t>(constants.size()),
                                            constants.data()));
}

SpecializationInfo::SpecializationInfo(const Specialization& constants) : values(constants) {
    for (std::uint32_t i = 0; i < values.size(); ++i)
        entries.push_back({.constantID = i, .offset = 4 * i, .size = 4});
    info = {.mapEntryCount = static_cast<std::uint32_t>(entries.size()),
            .pMapEntries = entries.data(),
            .dataSize = 4 * values.size(),
            .pData = values.data()};
}

vk::raii::ShaderModule makeShader(const Device& device, std::span<const std::uint32_t> spirv,
                                  const std::string& name) {
    vk::raii::ShaderModule module(
        device.vk(),
        vk::ShaderModuleCreateInfo{.codeSize = spirv.size_bytes(), .pCode = spirv.data()});
    device.name(module, name);
    return module;
}

Kernel::Kernel(const Device& device, const std::string& name, std::span<const std::uint32_t> spirv,
               const std::vector<SlotArray>& slots, std::uint32_t pushBytes,
               const Specialization& constants)
    : pipelineLayout(device, slots, pushBytes, vk::ShaderStageFlagBits::eCompute, name) {
    const vk::raii::ShaderModule module = makeShader(device, spirv, name);
    const SpecializationInfo specialization(constants);
    handle = vk::raii::Pipeline(
        device.vk(), nullptr,
        vk::ComputePipelineCreateInfo{.stage = {.stage = vk::ShaderStageFlagBits::eCompute,
                                                .module = *module,
                                                .pName = "main",
                                                .pSpecializationInfo = specialization.get()},
                                      .layout = *pipelineLayout.layout});
    device.name(handle, name);
}

}  // namespace lodestar::gpu
