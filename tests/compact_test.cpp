// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/readback.hpp>
#include <lodestar/visibility/compact.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::visibility {
namespace {

using small_scenes::Random;

template <typename T>
std::vector<std::uint32_t> words(const std::vector<T>& records) {
    std::vector<std::uint32_t> values(records.size() * sizeof(T) / 4);
    if (!values.empty()) std::memcpy(values.data(), records.data(), 4 * values.size());
    return values;
}

void expectSame(const Record& a, const Record& b) {
    EXPECT_EQ(words(a.heads), words(b.heads));
    EXPECT_EQ(words(a.nodes), words(b.nodes));
}

/// Ids as triangles leave them, patches and slivers, with some pixels of pure noise.
std::vector<std::uint32_t> someIds(vk::Extent2D base, std::uint32_t side, std::uint32_t seed) {
    Random random(seed);
    const std::uint32_t width = base.width * side, height = base.height * side;
    std::vector<std::uint32_t> ids(width * height);
    for (int patch = 0; patch < 40; ++patch) {
        const glm::vec3 normal = random.vec3(-1, 1);
        const float offset = random(-0.5f, 0.5f);
        const auto id = patch % 5 == 0 ? 0u : 0x7fffffffu - std::uint32_t(random(0, 1e6f));
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const float d = normal.x * float(x) / float(width) +
                                normal.y * float(y) / float(height) - offset;
                if (d > 0 && d < std::abs(normal.z) * 0.3f) ids[y * width + x] = id;
            }
    }
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            if ((x / side * 7 + y / side * 3 + seed) % 11 == 0)
                ids[y * width + x] = 1 + std::uint32_t(random(0, float(side * side)));
    return ids;
}

class CompactTest : public GpuTest {
protected:
    static gpu::Image imageOf(const std::vector<std::uint32_t>& ids, vk::Extent2D extent) {
        using Usage = vk::ImageUsageFlagBits;
        gpu::Image image(device(), {.name = "ids",
                                    .format = vk::Format::eR32Uint,
                                    .extent = extent,
                                    .usage = Usage::eSampled | Usage::eTransferDst});
        gpu::uploadImage(device(), image, 0, std::as_bytes(std::span(ids)));
        return image;
    }
    static gpu::TexelBuffer wordsOf(const std::vector<std::uint32_t>& ids) {
        std::vector<std::uint64_t> values;
        for (const std::uint32_t id : ids) values.push_back(id | 0x123456789abcdefull << 32);
        if (values.size() % 2 != 0) values.push_back(0);  // they are read by two
        return gpu::makeTexelBuffer(device(), "words", values, vk::Format::eR32G32Uint);
    }

    /// The record on the device, in bands of `rows`, of samples in an image or a buffer.
    static CompactRecord compact(const std::vector<std::uint32_t>& ids, vk::Extent2D base,
                                 std::uint32_t side, std::uint32_t rows, bool fromBuffer,
                                 std::uint32_t capacity) {
        const Compact pass(device(), side);
        const Compact::Scratch scratch(device(), base.width * rows);
        const std::uint32_t bands = (base.height + rows - 1) / rows;
        CompactRecord out(device(), base, side, capacity, bands);
        for (std::uint32_t i = 0; i < bands; ++i) {
            const Band band{i, i * rows, std::min(rows, base.height - i * rows)};
            const std::size_t row = std::size_t{base.width} * side;
            const std::vector<std::uint32_t> part(
                ids.begin() + std::ptrdiff_t(row * band.firstRow * side),
                ids.begin() + std::ptrdiff_t(row * (band.firstRow + band.rows) * side));
            const gpu::Image image = imageOf(part, {base.width * side, band.rows * side});
            const gpu::TexelBuffer words = wordsOf(part);
            const gpu::TexelView pairs(device(), words, vk::Format::eR32G32B32A32Uint);
            gpu::Recorder rec(device());
            rec.begin();
            pass.record(rec, fromBuffer ? Samples{.pairs = &pairs} : Samples{.ids = &image}, band,
                        scratch, out);
            rec.submit();
        }
        return out;
    }
};

TEST_F(CompactTest, equalsTheReferenceAtOddSizesAndEveryRate) {
    std::uint32_t seed = 1;
    for (const vk::Extent2D base : {vk::Extent2D{1, 1}, {17, 33}, {64, 9}, {3, 50}})
        for (const std::uint32_t side : {1u, 2u, 4u, 8u})
            for (const bool fromBuffer : {false, true}) {
                SCOPED_TRACE(testing::Message() << base.width << "x" << base.height << " s " << side
                                                << (fromBuffer ? " buffer" : " image"));
                const auto ids = someIds(base, side, seed++);
                const Record expected = compactReference(ids, base.width, base.height, side);
                const CompactRecord out =
                    compact(ids, base, side, base.height, fromBuffer, 1u << 20);
                ASSERT_EQ(out.wordsNeeded(), pack(expected).lists.size());
                expectSame(readRecord(device(), out), expected);
                ASSERT_EQ(expandReference(expected), ids);
            }
}

TEST_F(CompactTest, bandsDoNotChangeAByte) {
    const vk::Extent2D base{23, 31};
    const auto ids = someIds(base, 4, 99);
    const Record whole = compactReference(ids, base.width, base.height, 4);
    ASSERT_GT(whole.nodes.size(), 100u);
    for (const std::uint32_t rows : {1u, 5u, 16u, 31u})
        expectSame(readRecord(device(), compact(ids, base, 4, rows, rows == 5, 1u << 16)), whole);
}

TEST_F(CompactTest, overflowIsSeenAndWritesNothingPastTheEnd) {
    const vk::Extent2D base{16, 16};
    const auto ids = someIds(base, 8, 5);
    const Record whole = compactReference(ids, base.width, base.height, 8);
    const auto needed = static_cast<std::uint32_t>(pack(whole).lists.size());
    const CompactRecord small = compact(ids, base, 8, 16, false, needed - 1);
    EXPECT_TRUE(small.overflowed());
    EXPECT_EQ(small.wordsNeeded(), needed);
    EXPECT_THROW(readRecord(device(), small), std::logic_error);
    const CompactRecord enough = compact(ids, base, 8, 16, false, needed);
    EXPECT_FALSE(enough.overflowed());
    expectSame(readRecord(device(), enough), whole);
    // What an overflowed record does hold is safe to walk.
    const auto heads = gpu::as<std::uint32_t>(
        gpu::readBuffer(device(), small.heads.buffer(), 4 * base.width * base.height));
    for (const std::uint32_t head : heads)
        EXPECT_TRUE((head & shared::LS_HEAD_LIST) == 0 ||
                    (head & ~shared::LS_HEAD_LIST) + 2 < needed - 1);
}

TEST_F(CompactTest, uploadedRecordsReadBackTheSame) {
    const auto ids = someIds({9, 7}, 2, 3);
    const Record record = compactReference(ids, 9, 7, 2);
    expectSame(readRecord(device(), uploadRecord(device(), record)), record);
}

TEST(RecordReference, representativeHasMostSamplesAndTiesGoToTheSmallerId) {
    // Two pixels of 2 × 2 samples: 3 of 4 show 9; then 7 and 5 share evenly.
    const std::vector<std::uint32_t> ids{9, 4, 7, 5, 9, 9, 5, 7};
    const Record r = compactReference(ids, 2, 1, 2);
    ASSERT_EQ(r.nodes.size(), 2u);
    EXPECT_EQ(r.heads[0].id, 9u);
    EXPECT_EQ(idOf(r.nodes[0]), 4u);
    EXPECT_EQ(maskOf(r.nodes[0]), 2u);
    EXPECT_EQ(r.heads[1].id, 5u);
    EXPECT_EQ(idOf(r.nodes[1]), 7u);
    EXPECT_EQ(maskOf(r.nodes[1]), 9u);
    EXPECT_TRUE(isLast(r.nodes[0]) && isLast(r.nodes[1]));
    // The thesis: two 8-byte heads and two 16-byte nodes for each of the two mixed pixels.
    EXPECT_EQ(bytesOf(r).thesisTotal(), 2 * 8 + 4 * 16u);
    // Here: two words, and two lists of a representative and a node of two words.
    EXPECT_EQ(bytesOf(r).total(), 4 * (2 + 2 * 3u));
    const PackedRecord packed = pack(r);
    constexpr std::uint32_t kList = shared::LS_HEAD_LIST, kLast = shared::LS_LAST_NODE;
    EXPECT_EQ(packed.heads, (std::vector<std::uint32_t>{kList, kList | 3}));
    EXPECT_EQ(packed.lists, (std::vector<std::uint32_t>{9, 4 | kLast, 2, 5, 7 | kLast, 9}));
}

TEST(RecordReference, pixelsOfOneTriangleHaveNoList) {
    const Record r = compactReference(std::vector<std::uint32_t>{3, 3, 0, 0}, 4, 1, 1);
    EXPECT_TRUE(r.nodes.empty());
    EXPECT_EQ(r.heads[0].list, kNoList);
    EXPECT_EQ(r.heads[2].list, kNoList);
    EXPECT_EQ(pack(r).heads, (std::vector<std::uint32_t>{3, 3, 0, 0}));
    EXPECT_EQ(r.fullMask(), 1u);
    EXPECT_THROW(compactReference(std::vector<std::uint32_t>(5), 2, 1, 2), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::visibility
