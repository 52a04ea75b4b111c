// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/list_tiles_params.h>
#include <lodestar/visibility/list_tiles.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/list_tiles.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

}  // namespace

ListTiles::ListTiles(const gpu::Device& device)
    : pointSampler(device.vk(),
                   vk::SamplerCreateInfo{.addressModeU = vk::SamplerAddressMode::eClampToEdge,
                                         .addressModeV = vk::SamplerAddressMode::eClampToEdge}),
      kernel(device, "list tiles", kCode,
             {Slot::sampledImage, Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
              Slot::storageBuffer},
             sizeof(shared::ListTilesParams)) {}

void ListTiles::record(gpu::Recorder& rec, gpu::View ids, const gpu::TileList& covered,
                       const gpu::TileList& empty) const {
    const auto pass = rec.pass("list tiles");
    for (const gpu::TileList* list : {&covered, &empty}) {
        rec.fill(list->groups, 0);
        rec.update(list->tiles.buffer(), std::uint32_t{0});  // how many
    }
    rec.barrier(Stage::transfer, Stage::compute);
    const vk::Extent2D size = ids.extent;
    rec.dispatch(kernel, gpu::groups8x8({gpu::groups(size.width, 8), gpu::groups(size.height, 8)}),
                 {{ids, pointSampler},
                  covered.groups,
                  covered.tiles.buffer(),
                  empty.groups,
                  empty.tiles.buffer()},
                 shared::ListTilesParams{.size = {size.width, size.height}});
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);
}

}  // namespace lodestar::visibility
