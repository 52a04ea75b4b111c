// SPDX-License-Identifier: Apache-2.0
// .lvis streams: what goes in comes out, and what lies is refused with one line. Worth most under
// the asan preset.
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include <lodestar/scene/procedural.hpp>
#include <lodestar/visibility/stream_code.hpp>

namespace lodestar::visibility {
namespace {

using Bytes = std::vector<std::byte>;

/// Half-planes of triangles over one another, as a picture has them.
Record picture(std::uint32_t width, std::uint32_t height, std::uint32_t side, std::uint32_t seed,
               int edges = 30) {
    std::mt19937 random(seed);
    const auto unit = [&] { return double(random() >> 8) / double(1 << 24); };
    const std::uint32_t w = width * side, h = height * side;
    std::vector<std::uint32_t> ids(std::size_t{w} * h);
    for (int i = 0; i < edges; ++i) {
        const double angle = 6.28 * unit(), distance = unit() - 0.5, thick = 0.2 * unit();
        const std::uint32_t id = i % 7 == 0 ? 0 : (1 + random() % 4000) << 7 | random() % 124;
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const double d = std::cos(angle) * ((x + 0.5) / w - 0.5) +
                                 std::sin(angle) * ((y + 0.5) / h - 0.5) - distance;
                if (d > 0 && d < thick) ids[std::size_t{y} * w + x] = id;
            }
    }
    return compactReference(ids, width, height, side);
}

Stream streamOf(Record record) {
    return {.record = std::move(record),
            .camera = {.eye = {1, 2, 3}, .at = {4, 5, 6}, .verticalFov = 1.1f, .nearPlane = 0.2f},
            .aspect = 1.6f,
            .seconds = 2.5f,
            .scene = "scenes/é.glb",
            .sceneHash = 0x0123456789abcdefull,
            .clusterHash = 42};
}

Result<Stream> decode(const Bytes& file, const DecodeOptions& options = {}) {
    const Bytes exact(file);  // capacity = size, for ASan
    return decodeStream(exact, "f.lvis", options);
}

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expectSame(const Stream& a, const Stream& b) {
    EXPECT_EQ(a.record.width, b.record.width);
    EXPECT_EQ(a.record.height, b.record.height);
    EXPECT_EQ(a.record.side, b.record.side);
    EXPECT_TRUE(sameBytes(a.record.heads, b.record.heads));
    EXPECT_TRUE(sameBytes(a.record.nodes, b.record.nodes));
    EXPECT_EQ(a.camera.eye, b.camera.eye);
    EXPECT_EQ(a.camera.at, b.camera.at);
    EXPECT_EQ(a.camera.up, b.camera.up);
    EXPECT_EQ(a.camera.verticalFov, b.camera.verticalFov);
    EXPECT_EQ(a.camera.nearPlane, b.camera.nearPlane);
    EXPECT_EQ(a.aspect, b.aspect);
    EXPECT_EQ(a.seconds, b.seconds);
    EXPECT_EQ(a.scene, b.scene);
    EXPECT_EQ(a.sceneHash, b.sceneHash);
    EXPECT_EQ(a.clusterHash, b.clusterHash);
}

/// Refused with one line that names the file and says what to do, or decodes.
void expectOneLineOrRecord(const Bytes& file, const DecodeOptions& options) {
    const auto stream = decode(file, options);
    if (stream) {
        expandReference(stream->record);
        return;
    }
    const std::string& message = stream.error().message;
    EXPECT_TRUE(message.starts_with("f.lvis: ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
}

TEST(Stream, whatGoesInComesOut) {
    for (const std::uint32_t side : {1u, 2u, 4u, 8u})
        for (const auto& [width, height] : {std::pair{1u, 1u}, {17u, 33u}, {40u, 23u}})
            for (const bool predict : {true, false}) {
                const Stream stream = streamOf(picture(width, height, side, side));
                const auto back = decode(encodeStream(stream, {.predictIds = predict}));
                ASSERT_TRUE(back) << back.error().message;
                expectSame(*back, stream);
            }
}

TEST(Stream, equalRecordsGiveEqualBytes) {
    const Stream stream = streamOf(picture(30, 20, 4, 1));
    EXPECT_EQ(encodeStream(stream), encodeStream(stream));
}

TEST(Stream, codingIdsByTheirNeighboursPays) {
    const Stream stream = streamOf(picture(160, 90, 8, 3, 400));
    ASSERT_GT(stream.record.nodes.size(), 3000u);
    const auto predicted = encodeStream(stream).size();
    EXPECT_LT(double(predicted), 0.9 * double(encodeStream(stream, {.predictIds = false}).size()));
    EXPECT_LT(double(predicted), 0.2 * double(bytesOf(stream.record).thesisTotal()));
}

TEST(Stream, everyTruncationIsRefused) {
    const Bytes file = encodeStream(streamOf(picture(9, 7, 8, 5)));
    for (std::size_t size = 0; size < file.size(); ++size)
        for (const bool checksum : {true, false}) {
            const Bytes part(file.begin(), file.begin() + std::ptrdiff_t(size));
            EXPECT_FALSE(decode(part, {.checksum = checksum})) << size;
            expectOneLineOrRecord(part, {.checksum = checksum});
        }
}

TEST(Stream, everyFlippedBitIsRefused) {
    Bytes file = encodeStream(streamOf(picture(9, 7, 8, 5)));
    for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
        file[bit / 8] ^= std::byte(1u << bit % 8);
        EXPECT_FALSE(decode(file)) << "bit " << bit;
        // Past the checksum, it may decode to something else, but never badly.
        expectOneLineOrRecord(file, {.checksum = false, .maxBytes = 16 << 20});
        file[bit / 8] ^= std::byte(1u << bit % 8);
    }
}

TEST(Stream, saysWhatIsWrong) {
    const Bytes good = encodeStream(streamOf(picture(4, 4, 2, 5)));
    const auto message = [](const Bytes& file, bool checksum = true) {
        const auto stream = decode(file, {.checksum = checksum});
        return stream ? std::string() : stream.error().message;
    };
    const auto with = [&](std::size_t at, std::uint32_t value) {
        Bytes file = good;
        std::memcpy(file.data() + at, &value, 4);
        return file;
    };
    EXPECT_NE(message({}).find("not a .lvis stream"), std::string::npos);
    EXPECT_NE(message(with(4, 9)).find("version 9"), std::string::npos);
    EXPECT_NE(message(with(140, 77)).find("checksum"), std::string::npos);
    EXPECT_NE(message(with(40, 3)).find("byte 40"), std::string::npos);
    EXPECT_NE(message(with(32, 1u << 20)).find("byte 32"), std::string::npos);
    EXPECT_NE(message(with(44, 1u << 20)).find("byte 44"), std::string::npos);
    EXPECT_NE(message(with(84, 0)).find("byte 84"), std::string::npos);
    EXPECT_NE(message(with(32, 5), false).find("pixels coded"), std::string::npos);
    // A name longer than the file, with no frame after it.
    Bytes named = with(104, 1000);
    std::memset(named.data() + 120, 0, 8);
    EXPECT_NE(message(named, false).find("byte 120"), std::string::npos);
    // A picture that would take gigabytes is refused before anything is allocated.
    Bytes big = with(32, 2048);
    const std::uint32_t height = 2048;
    std::memcpy(big.data() + 36, &height, 4);
    EXPECT_NE(decode(big, {.checksum = false, .maxBytes = 1 << 20}).error().message.find("memory"),
              std::string::npos);
}

TEST(Stream, refusesToEncodeARecordThatBreaksItsRules) {
    const Stream good = streamOf(picture(9, 7, 4, 5));
    ASSERT_FALSE(good.record.nodes.empty());
    Stream bad = good;
    bad.record.nodes.back().id &= ~shared::LS_LAST_NODE;
    EXPECT_THROW(encodeStream(bad), std::invalid_argument);
    bad = good;
    bad.record.heads.pop_back();
    EXPECT_THROW(encodeStream(bad), std::invalid_argument);
    bad = good;
    bad.scene = std::string(2000, 'x');
    EXPECT_THROW(encodeStream(bad), std::invalid_argument);
}

TEST(SceneHash, seesEveryKindOfChange) {
    const scene::Scene base = *scene::buildBuiltin("spheres");
    const std::uint64_t hash = hashOf(base);
    EXPECT_EQ(hashOf(*scene::buildBuiltin("spheres")), hash);
    const auto changed = [&](auto&& change) {
        scene::Scene scene = base;
        change(scene);
        return hashOf(scene) != hash;
    };
    EXPECT_TRUE(changed([](auto& s) { s.meshes[0].vertices[3].position.y += 1e-5f; }));
    EXPECT_TRUE(
        changed([](auto& s) { std::swap(s.meshes[0].indices[0], s.meshes[0].indices[1]); }));
    EXPECT_TRUE(changed([](auto& s) { s.nodes.back().translation.x += 1e-5f; }));
    EXPECT_TRUE(changed([](auto& s) { s.materials[0].roughness += 0.01f; }));
    EXPECT_TRUE(changed([](auto& s) { s.instances.pop_back(); }));
    EXPECT_FALSE(changed([](auto& s) { s.name = "another name"; }));
}

}  // namespace
}  // namespace lodestar::visibility
