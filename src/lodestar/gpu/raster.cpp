// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/raster.hpp>

namespace lodestar::gpu {

RasterPipeline::RasterPipeline(const Device& device, const RasterInfo& info)
    : pipelineLayout(device, info.slots, info.pushBytes,
                     vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment,
                     info.name) {
    const SpecializationInfo specialization(info.constants);
    std::vector<vk::raii::ShaderModule> modules;
    std::vector<vk::PipelineShaderStageCreateInfo> stages;
    const auto addStage = [&](vk::ShaderStageFlagBits stage, std::span<const std::uint32_t> code) {
        if (code.empty()) return;
        modules.push_back(makeShader(device, code, info.name));
        stages.push_back({.stage = stage,
                          .module = *modules.back(),
                          .pName = "main",
                          .pSpecializationInfo = specialization.get()});
    };
    addStage(vk::ShaderStageFlagBits::eVertex, info.vertex);
    addStage(vk::ShaderStageFlagBits::eFragment, info.fragment);

    const vk::PipelineVertexInputStateCreateInfo vertexInput;
    const vk::PipelineInputAssemblyStateCreateInfo assembly{
        .topology = vk::PrimitiveTopology::eTriangleList};
    const vk::PipelineViewportStateCreateInfo viewport{.viewportCount = 1, .scissorCount = 1};
    const vk::PipelineRasterizationStateCreateInfo rasterization{
        .depthClampEnable = info.depthClamp,
        .polygonMode = vk::PolygonMode::eFill,
        .cullMode = info.cull,
        .frontFace = vk::FrontFace::eCounterClockwise,
        .lineWidth = 1};
    const vk::PipelineMultisampleStateCreateInfo multisample{
        .rasterizationSamples = vk::SampleCountFlagBits(info.samples),
        .sampleShadingEnable = info.sampleShading,
        .minSampleShading = 1};
    const vk::PipelineDepthStencilStateCreateInfo depthStencil{
        .depthTestEnable = true,
        .depthWriteEnable = true,
        .depthCompareOp = vk::CompareOp::eGreater};
    using Component = vk::ColorComponentFlagBits;
    const std::vector<vk::PipelineColorBlendAttachmentState> attachments(
        info.colors.size(),
        {.colorWriteMask = Component::eR | Component::eG | Component::eB | Component::eA});
    const vk::PipelineColorBlendStateCreateInfo blend{
        .attachmentCount = static_cast<std::uint32_t>(attachments.size()),
        .pAttachments = attachments.data()};
    const std::array dynamics{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
    const vk::PipelineDynamicStateCreateInfo dynamic{
        .dynamicStateCount = static_cast<std::uint32_t>(dynamics.size()),
        .pDynamicStates = dynamics.data()};
    const vk::PipelineRenderingCreateInfo rendering{
        .colorAttachmentCount = static_cast<std::uint32_t>(info.colors.size()),
        .pColorAttachmentFormats = info.colors.data(),
        .depthAttachmentFormat = info.depth};
    handle = vk::raii::Pipeline(
        device.vk(), nullptr,
        vk::GraphicsPipelineCreateInfo{.pNext = &rendering,
                                       .stageCount = static_cast<std::uint32_t>(stages.size()),
                                       .pStages = stages.data(),
                                       .pVertexInputState = &vertexInput,
                                       .pInputAssemblyState = &assembly,
                                       .pViewportState = &viewport,
                                       .pRasterizationState = &rasterization,
                                       .pMultisampleState = &multisample,
                                       .pDepthStencilState = &depthStencil,
                                       .pColorBlendState = &blend,
                                       .pDynamicState = &dynamic,
                                       .layout = *pipelineLayout.layout});
    device.name(handle, info.name);
}

}  // namespace lodestar::gpu
