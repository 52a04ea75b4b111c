// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/hiz.hpp>

namespace lodestar::geometry {
namespace {

constexpr std::uint32_t kImageCode[] =
#include <lodestar/geometry/hiz.comp.inc>
    ;
constexpr std::uint32_t kHalveCode[] =
#include <lodestar/geometry/hiz_halve.comp.inc>
    ;

constexpr std::uint32_t kWordsCode[] =
#include <lodestar/geometry/hiz_words.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

std::vector<HiZ::Level> levelsOf(vk::Extent2D size) {
    if (size.width == 0 || size.height == 0) throw std::invalid_argument("HiZ: size is 0");
    std::vector<HiZ::Level> levels;
    std::uint32_t offset = 0;
    for (std::uint32_t k = shared::LS_HIZ_FIRST; k < shared::LS_HIZ_LEVELS; ++k) {
        const std::uint32_t texel = 1u << k;
        levels.push_back({gpu::groups(size.width, texel), gpu::groups(size.height, texel), offset});
        offset += levels.back().width * levels.back().height;
        if (levels.back().width == 1 && levels.back().height == 1) return levels;
    }
    throw std::invalid_argument("HiZ: size is over 32768 pixels");
}

std::uint32_t texelsOf(const std::vector<HiZ::Level>& levels) {
    return levels.back().offset + 1;
}

constexpr std::uint32_t kPush = sizeof(shared::HizParams);

}  // namespace

HiZ::HiZ(const gpu::Device& device, vk::Extent2D size, const std::string& name)
    : extent(size),
      all(levelsOf(size)),
      texels(device, name, 4ull * texelsOf(all), vk::Format::eR32Sfloat),
      fromImage(device, "hi-z: from depth", kImageCode, {Slot::sampledImage, Slot::storageBuffer},
                kPush),
      fromWords(device, "hi-z: from words", kWordsCode, {Slot::texelBuffer, Slot::storageBuffer},
                kPush),
      next(device, "hi-z: halve", kHalveCode, {Slot::texelBuffer, Slot::storageBuffer}, kPush),
      sampler(device.vk(), vk::SamplerCreateInfo{}) {}

void HiZ::record(gpu::Recorder& rec, gpu::View depth, const glm::mat4& clipFromWorld) {
    recordLevels(rec, fromImage, {{depth, sampler}, texels.buffer()}, depth.extent, clipFromWorld);
}

void HiZ::record(gpu::Recorder& rec, const gpu::TexelBuffer& words, vk::Extent2D size,
                 const glm::mat4& clipFromWorld) {
    recordLevels(rec, fromWords, {words, texels.buffer()}, size, clipFromWorld);
}

void HiZ::recordLevels(gpu::Recorder& rec, const gpu::Kernel& kernel,
                       const std::vector<gpu::Binding>& picture, vk::Extent2D size,
                       const glm::mat4& clipFromWorld) {
    const auto pass = rec.pass("hi-z");
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Level& to = all[i];
        shared::HizParams params{.to = {to.width, to.height}, .toOffset = to.offset};
        const std::uint32_t groups = gpu::groups(to.width * to.height, 64);
        const std::uint32_t rows = gpu::groups(groups, 32768);
        const vk::Extent3D grid{gpu::groups(groups, rows), rows, 1};
        if (i == 0) {
            params.from = {size.width, size.height};
            params.scale = glm::vec2(params.from) / glm::vec2(extent.width, extent.height);
            rec.dispatch(kernel, grid, picture, params);
            continue;
        }
        params.from = {all[i - 1].width, all[i - 1].height};
        params.fromOffset = all[i - 1].offset;
        rec.barrier(Stage::compute, Stage::compute);
        rec.dispatch(next, grid, {texels, texels.buffer()}, params);
    }
    seenFrom = clipFromWorld;
    built = true;
}

}  // namespace lodestar::geometry
