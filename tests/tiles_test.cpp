// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <random>
#include <set>

#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/procedural.hpp>
#include <lodestar/visibility/list_tiles.hpp>

#include "gpu_device.hpp"

namespace lodestar {
namespace {

using Usage = vk::ImageUsageFlagBits;

class TilesTest : public GpuTest {};

/// What a list holds, and that a dispatch over its groups reaches all of it.
std::set<std::uint32_t> read(const gpu::Device& device, const gpu::TileList& list) {
    const auto words = gpu::as<std::uint32_t>(
        gpu::readBuffer(device, list.tiles.buffer(), list.tiles.buffer().bytes()));
    const auto groups = gpu::as<std::uint32_t>(gpu::readBuffer(device, list.groups, 12));
    const std::uint32_t count = words.at(0), reached = groups[0] * groups[1] * groups[2];
    EXPECT_GE(reached, count);
    EXPECT_LT(reached, count + 128);
    const auto first = words.begin() + 1;
    std::set<std::uint32_t> tiles(first, first + count);
    EXPECT_EQ(tiles.size(), count) << "a tile is listed twice";
    return tiles;
}

TEST_F(TilesTest, eachIsListedOnceByWhetherItShowsSomething) {
    std::mt19937 random(7);
    const visibility::ListTiles pass(device());
    for (const vk::Extent2D size : {vk::Extent2D{1, 1}, {8, 8}, {61, 35}, {256, 200}}) {
        // A part of an image, beside which something is seen everywhere.
        const vk::Extent2D whole{size.width + 3, size.height + 5};
        const gpu::Image ids(device(), {.name = "ids",
                                        .format = vk::Format::eR32Uint,
                                        .extent = whole,
                                        .usage = Usage::eSampled | Usage::eTransferDst});
        const gpu::TileList covered(device(), size, "covered"), empty(device(), size, "empty");
        for (const double share : {0.0, 0.02, 1.0}) {
            std::vector<std::uint32_t> texels(whole.width * whole.height, 1);
            std::set<std::uint32_t> expected, rest;
            for (std::uint32_t y = 0; y < size.height; ++y)
                for (std::uint32_t x = 0; x < size.width; ++x) {
                    std::uint32_t& id = texels[y * whole.width + x];
                    id = std::bernoulli_distribution(share)(random) ? 1 + random() % 1000 : 0;
                    (id ? expected : rest).insert(x / 8 | y / 8 << 16);
                }
            for (const std::uint32_t tile : expected) rest.erase(tile);
            gpu::uploadImage(device(), ids, 0, std::as_bytes(std::span(texels)));
            gpu::Recorder rec(device());
            rec.begin();
            pass.record(rec, gpu::part(ids, size), covered, empty);
            rec.submit();
            EXPECT_EQ(read(device(), covered), expected);
            EXPECT_EQ(read(device(), empty), rest);
        }
    }
}

/// A frame in which nothing is seen any more leaves nothing of the one before.
TEST_F(TilesTest, theSkyReplacesWhatWasSeenThere) {
    const auto scene = *scene::buildBuiltin("columns");
    const scene::GpuScene onGpu(device(), scene);
    const frame::FrameSettings settings{.size = {90, 70}, .shadowMapSize = 256};
    const float far = 20 * onGpu.bounds().radius();
    const glm::vec3 middle = onGpu.bounds().centre();
    const scene::Camera near{.eye = middle + glm::vec3(0, 1, 3), .at = middle};
    const scene::Camera away{.eye = middle + glm::vec3(0, far / 20, far), .at = middle};
    for (const budget::Levers& levers :
         {budget::Levers{}, {.shadingRate = 3}, {.shadingRate = 3, .resizeAll = true}}) {
        frame::Frame used(device(), onGpu, settings), fresh(device(), onGpu, settings);
        used.render(near, {});
        used.render(away, levers);
        fresh.render(away, levers);
        const auto ids = gpu::as<std::uint32_t>(gpu::readImage(device(), used.ids()));
        const auto seen = std::count_if(ids.begin(), ids.end(), [](auto id) { return id != 0; });
        EXPECT_GT(seen, 0);
        EXPECT_LT(seen, std::ptrdiff_t(ids.size() / 4));
        EXPECT_EQ(gpu::readImage(device(), used.display()),
                  gpu::readImage(device(), fresh.display()));
        EXPECT_EQ(gpu::readImage(device(), used.radiance()),
                  gpu::readImage(device(), fresh.radiance()));
        const auto depth = gpu::as<float>(gpu::readImage(device(), used.depth()));
        for (std::size_t i = 0; i < ids.size(); ++i) ASSERT_EQ(depth[i] > 0, ids[i] != 0) << i;
    }
}

}  // namespace
}  // namespace lodestar
