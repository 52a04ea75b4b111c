// SPDX-License-Identifier: Apache-2.0
// What a hostile glTF file brings along: other files, images, compressed data.
#include <filesystem>
#include <fstream>

#include <lodestar/scene/import.hpp>

#include "hostile_gltf.hpp"

namespace lodestar::scene {
namespace {

// --- files beside the scene --------------------------------------------------------------------

class HostileUri : public testing::Test {
protected:
    void SetUp() override {
        std::filesystem::remove_all(root);
        std::filesystem::create_directories(root / "scene" / "sub");
        for (const auto& file : {root / "secret.bin", root / "scene" / "sub" / "a b.bin"})
            std::ofstream(file, std::ios::binary).write("0123456789ab", 12);
    }
    void TearDown() override { std::filesystem::remove_all(root); }

    std::string load(const std::string& uri, std::size_t length = 12) const {
        const nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                                     {"buffers", {{{"uri", uri}, {"byteLength", length}}}}};
        const std::filesystem::path path = root / "scene" / "s.gltf";
        std::ofstream(path) << json;
        return outcome(importGltf(path), "s.gltf");
    }

    std::filesystem::path root =
        std::filesystem::path(testing::TempDir()) /
        (std::string("lodestar_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(HostileUri, filesBelowTheSceneAreRead) {
    EXPECT_EQ(load("sub/a%20b.bin"), "");
    EXPECT_EQ(load("sub/a b.bin", 5), "");  // longer than declared is fine
    EXPECT_EQ(load("sub/../sub/a b.bin"), "");
}

TEST_F(HostileUri, filesElsewhereAreNot) {
    for (const std::string& uri :
         {std::string("../secret.bin"), std::string("sub/../../secret.bin"),
          std::string("%2e%2e/secret.bin"), std::string("..%5csecret.bin"),
          (root / "secret.bin").string(), "file://" + (root / "secret.bin").string(),
          std::string("https://example.org/x.bin"), std::string("C:/secret.bin"), std::string(),
          std::string("\n\x1b[31m"), std::string("."), std::string("sub")})
        EXPECT_TRUE(load(uri).starts_with("s.gltf: /buffers/0/uri")) << uri << ": " << load(uri);
}

TEST_F(HostileUri, linksDoNotLeadOut) {
    std::error_code error;
    std::filesystem::create_symlink(root / "secret.bin", root / "scene" / "link.bin", error);
    if (error) GTEST_SKIP() << "no symbolic links here";
    EXPECT_NE(load("link.bin").find("leads out"), std::string::npos);
}

TEST_F(HostileUri, missingAndShortFilesAreNamed) {
    EXPECT_EQ(load("no.bin"),
              "s.gltf: /buffers/0/uri 'no.bin': there is no such file; put it where "
              "the scene looks for it");
    EXPECT_EQ(load("sub/a b.bin", 13),
              "s.gltf: /buffers/0/uri: 'sub/a b.bin' has 12 bytes where 13 "
              "are needed; export it again");
}

// --- images ------------------------------------------------------------------------------------

std::string imageOutcome(const Bytes& image) {
    GltfBuilder builder;
    builder.add("images", {{"bufferView", builder.view(image)}});
    builder.add("textures", {{"source", 0}});
    builder.add("materials", {{"emissiveTexture", {{"index", 0}}}});
    return outcome(builder);
}

Bytes pngHeader(std::uint32_t width, std::uint32_t height) {
    Bytes png = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
    for (const std::uint32_t size : {width, height})
        for (int i = 3; i >= 0; --i) png.push_back(static_cast<std::uint8_t>(size >> (8 * i)));
    png.insert(png.end(), {8, 6, 0, 0, 0, 0, 0, 0, 0});
    return png;
}

TEST(HostileGltf, imagesOverTheLimitsAreRefusedByTheirHeader) {
    EXPECT_NE(imageOutcome(pngHeader(20000, 1)).find("20000 x 1 texels are over the limit"),
              std::string::npos);
    EXPECT_NE(imageOutcome(pngHeader(16384, 16384)).find("over the limit"), std::string::npos);
}

TEST(HostileGltf, damagedAndForeignImagesAreNamed) {
    EXPECT_TRUE(imageOutcome(pngHeader(16, 16)).starts_with("hostile.glb: /images/0: "));
    const std::string gif = "GIF89a0123456789";
    EXPECT_NE(imageOutcome(Bytes(gif.begin(), gif.end())).find("neither a PNG nor a JPEG"),
              std::string::npos);
}

/// zlib data of `n` zero bytes at deflate's best ratio, in the fixed Huffman code.
Bytes zeros(std::size_t matches) {
    Bytes data = {0x78, 0x01};
    std::uint32_t bits = 0;
    int held = 0;
    const auto put = [&](std::uint32_t value, int count) {
        bits |= value << held;
        for (held += count; held >= 8; held -= 8, bits >>= 8)
            data.push_back(static_cast<std::uint8_t>(bits));
    };
    put(3, 3);     // last block, fixed code
    put(0x0c, 8);  // literal 0 (00110000, most significant bit first)
    for (std::size_t i = 0; i < matches; ++i) {
        put(0xa3, 8);  // length 258 (11000101, most significant bit first)
        put(0, 5);     // distance 1
    }
    put(0, 7);  // end
    put(0, 8);
    data.insert(data.end(), {0, 0, 0, 0});
    return data;
}

TEST(HostileGltf, inflationBombsAreRefused) {
    // A 16×16 picture whose data inflates to over a gigabyte.
    Bytes png = pngHeader(16, 16);
    const Bytes data = zeros(5'000'000);
    for (int i = 3; i >= 0; --i) png.push_back(static_cast<std::uint8_t>(data.size() >> (8 * i)));
    for (const char c : {'I', 'D', 'A', 'T'}) png.push_back(static_cast<std::uint8_t>(c));
    png.insert(png.end(), data.begin(), data.end());
    png.insert(png.end(), {0, 0, 0, 0, 0, 0, 0, 0, 'I', 'E', 'N', 'D', 0, 0, 0, 0});
    EXPECT_NE(imageOutcome(png).find("larger than the picture"), std::string::npos);
}

TEST(HostileGltf, jpegsOfTooManyScansAreRefused) {
    Bytes jpeg = {0xff, 0xd8, 0xff, 0xc2, 0, 11, 8, 0x10, 0, 0x10, 0, 1, 1, 0x11, 0};
    for (int i = 0; i < 1000; ++i) jpeg.insert(jpeg.end(), {0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0});
    EXPECT_NE(imageOutcome(jpeg).find("has 1000 scans"), std::string::npos);
}

// --- compressed data ---------------------------------------------------------------------------

TEST(HostileGltf, dracoHeadersAreNotBelieved) {
    for (const std::uint8_t method : {0, 1}) {
        GltfBuilder builder;
        Bytes draco = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, method, 0, 0};
        if (method == 1) draco.push_back(0);  // traversal
        for (int number = 0; number < 2; ++number)
            draco.insert(draco.end(), {0xff, 0xff, 0xff, 0xff, 0x0f});  // 2³² − 1
        draco.resize(64);
        nlohmann::json& primitive = builder.show({{"POSITION", 0}});
        builder.json["accessors"] = {{{"componentType", 5126}, {"type", "VEC3"}, {"count", 3}}};
        primitive["extensions"]["KHR_draco_mesh_compression"] = {
            {"bufferView", builder.view(draco)}, {"attributes", {{"POSITION", 0}}}};
        EXPECT_NE(outcome(builder).find("64 bytes can't hold 4294967295 triangles"),
                  std::string::npos);
    }
}

TEST(HostileGltf, damagedDracoDataIsRefusedOrLoads) {
    const std::filesystem::path folder = "/usr/share/assimp/models/glTF2/draco";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "install assimp-testmodels";
    nlohmann::json json;
    std::ifstream(folder / "2CylinderEngine.gltf") >> json;
    std::ifstream stream(folder / "2CylinderEngine.bin", std::ios::binary);
    const Bytes bin((std::istreambuf_iterator<char>(stream)), {});
    // The first small primitive alone.
    const nlohmann::json& view = json["bufferViews"][5];
    const auto begin = bin.begin() + view.value("byteOffset", 0);
    const Bytes draco(begin, begin + view["byteLength"].get<int>());
    nlohmann::json primitive;
    for (const nlohmann::json& mesh : json["meshes"])
        for (const nlohmann::json& candidate : mesh["primitives"])
            if (candidate["extensions"]["KHR_draco_mesh_compression"]["bufferView"] == 5)
                primitive = candidate;
    ASSERT_FALSE(primitive.is_null());
    primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 0;
    primitive.erase("material");
    const auto load = [&](const Bytes& data) {
        GltfBuilder builder;
        builder.view(data);
        builder.json["accessors"] = json["accessors"];
        builder.add("meshes", {{"primitives", {primitive}}});
        builder.add("nodes", {{"mesh", 0}});
        return outcome(builder);
    };
    EXPECT_EQ(load(draco), "");
    for (std::size_t length = 1; length < draco.size(); length += 1 + draco.size() / 50)
        load(Bytes(draco.begin(), draco.begin() + static_cast<std::ptrdiff_t>(length)));
    for (std::size_t bit = 0; bit < 8 * draco.size(); bit += 1 + draco.size() / 25) {
        Bytes damaged = draco;
        damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
        load(damaged);
    }
}

}  // namespace
}  // namespace lodestar::scene
