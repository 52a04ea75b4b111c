// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/show_lods_params.h>
#include <lodestar/geometry/show_lods.hpp>

#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::geometry {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/geometry/show_lods.comp.inc>
    ;

using gpu::Slot;

}  // namespace

ShowLods::ShowLods(const gpu::Device& device)
    : sampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "show lods", kCode,
             scene::withSceneSlots({Slot::sampledImage, Slot::storageImage}),
             sizeof(shared::ShowLodsParams)) {}

void ShowLods::record(gpu::Recorder& rec, const scene::GpuScene& scene, gpu::View ids,
                      gpu::View picture) const {
    const auto pass = rec.pass("show lods");
    rec.dispatch(kernel, gpu::groups8x8(picture.extent),
                 scene::withScene(scene, {{ids, sampler}, picture}),
                 shared::ShowLodsParams{glm::vec2(ids.extent.width, ids.extent.height) /
                                        glm::vec2(picture.extent.width, picture.extent.height)});
}

}  // namespace lodestar::geometry
