// SPDX-License-Identifier: Apache-2.0
#include <lodestar/upsample/upsample_params.h>
#include <lodestar/upsample/repair.hpp>

namespace lodestar::upsample {
namespace {

constexpr std::uint32_t kWorkgroups = 32;  // that walk a list

constexpr std::uint32_t kCountCode[] =
#include <lodestar/upsample/repair_count.comp.inc>
    ;
constexpr std::uint32_t kCutCode[] =
#include <lodestar/upsample/repair_cut.comp.inc>
    ;
constexpr std::uint32_t kCompactCode[] =
#include <lodestar/upsample/repair_compact.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

std::uint64_t pixels(vk::Extent2D size) {
    const std::uint64_t count = std::uint64_t(size.width) * size.height;
    if (count == 0 || count > (1ull << shared::LS_REPAIR_INDEX_BITS))
        throw std::invalid_argument("RepairList: 1 … 2^26 pixels");
    return count;
}

}  // namespace

RepairList::RepairList(const gpu::Device& device, vk::Extent2D extent)
    : size(extent),
      header(device, "repair: header", sizeof(shared::RepairHeader)),
      listed(device, "repair: listed", 4 * pixels(extent)),
      kept(device, "repair: kept", 4 * pixels(extent)) {}

RepairSelect::RepairSelect(const gpu::Device& device)
    : count(device, "repair count", kCountCode, {Slot::storageBuffer, Slot::storageBuffer}),
      cut(device, "repair cut", kCutCode, {Slot::storageBuffer},
          sizeof(shared::RepairSelectParams)),
      compact(device, "repair compact", kCompactCode,
              {Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer}) {}

void RepairSelect::clear(gpu::Recorder& rec, const RepairList& list) {
    rec.fill(list.header, 0);
    rec.barrier(Stage::transfer, Stage::compute);
}

void RepairSelect::record(gpu::Recorder& rec, const RepairList& list, float share) const {
    if (!(share >= 0 && share <= 1)) throw std::invalid_argument("RepairSelect: share is 0 … 1");
    const auto pass = rec.pass("select repair");
    const auto most = static_cast<std::uint32_t>(share * static_cast<float>(pixels(list.size)));
    rec.dispatch(count, {kWorkgroups, 1, 1}, {list.header, list.listed});
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatch(cut, {1, 1, 1}, {list.header}, shared::RepairSelectParams{most});
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatch(compact, {kWorkgroups, 1, 1}, {list.header, list.listed, list.kept});
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);
}

}  // namespace lodestar::upsample
