// SPDX-License-Identifier: Apache-2.0
// Files that lie: each loads or is refused with one line, and nothing else happens. Worth most
// under the asan preset.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <lodestar/scene/import.hpp>
#include <lodestar/scene/import_gltf.hpp>

#include "gltf_builder.hpp"
#include "scenes.hpp"

namespace lodestar::scene {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The error of an import, "" if it loads. An error has to be one line that names the file.
std::string outcome(const Result<Scene>& scene, const std::string& name) {
    if (scene) {
        for (const Mesh& mesh : scene->meshes)
            for (const std::uint32_t index : mesh.indices) EXPECT_LT(index, mesh.vertices.size());
        const Bounds bounds = worldBounds(*scene, worldFromNode(*scene));
        EXPECT_TRUE(scene->instances.empty() || glm::length(bounds.upper - bounds.lower) < 1e30f);
        return "";
    }
    const std::string& message = scene.error().message;
    EXPECT_TRUE(message.starts_with(name + ": ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find("; "), std::string::npos) << "says nothing to do: " << message;
    return message;
}

std::string outcome(const Bytes& file) {
    const Bytes exact(file);  // capacity = size, for ASan
    return outcome(importGltfFromMemory(exact, "hostile.glb"), "hostile.glb");
}
std::string outcome(const GltfBuilder& builder) {
    return outcome(builder.glb());
}
std::string outcome(const std::string& json) {
    return outcome(Bytes(json.begin(), json.end()));
}

void expectRefusedAt(const GltfBuilder& builder, const std::string& place) {
    const std::string message = outcome(builder);
    EXPECT_TRUE(message.starts_with("hostile.glb: " + place + ": ")) << "got: " << message;
}

/// A file with a bit of everything: mesh, indices, sparse, material, image, skin, animation.
GltfBuilder everything() {
    GltfBuilder b;
    const std::size_t position = b.floats(kTriangle, "VEC3");
    const std::size_t normal = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const std::size_t joints = b.accessor(b.view(Bytes(12, 0)), 5121, "VEC4", 3);
    const std::size_t weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    nlohmann::json& primitive = b.show(
        {{"POSITION", position}, {"NORMAL", normal}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}});
    primitive["indices"] = b.shorts({0, 1, 2});
    primitive["material"] = 0;
    const std::size_t delta = b.floats(std::vector<float>(9, 0.5f), "VEC3");
    b.json["accessors"][delta]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view(Bytes{2})}, {"componentType", 5121}}},
        {"values", {{"bufferView", b.view(std::vector<float>{1, 2, 3})}}}};
    b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", delta}}};
    b.json["meshes"][0]["weights"] = {0.5};
    b.json["nodes"][0]["skin"] = 0;
    b.add("nodes", {{"children", {2}}, {"rotation", {0, 0, 0, 1}}});
    b.add("nodes", {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.json["scenes"] = {{{"nodes", {0, 1}}}};
    b.json["scene"] = 0;
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    b.add("skins", {{"joints", {1}}});
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    b.add("materials", {{"normalTexture", {{"index", 0}}}});
    b.add("textures", {{"source", 0}, {"sampler", 0}});
    b.add("samplers", {{"wrapS", 33071}});
    // A 1×1 grey PNG.
    const Bytes png = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                       0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
                       0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00,
                       0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0x00, 0x00, 0x00,
                       0x82, 0x00, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0x00, 0x00, 0x00, 0x00, 0x49,
                       0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    b.add("images", {{"bufferView", b.view(png)}, {"mimeType", "image/png"}});
    const std::size_t times = b.floats({0, 1}, "SCALAR");
    const std::size_t moves = b.floats({0, 0, 0, 1, 0, 0}, "VEC3");
    b.add("animations",
          {{"samplers", {{{"input", times}, {"output", moves}}}},
           {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
    return b;
}

TEST(HostileGltf, theSeedOfTheseTestsLoads) {
    const Result<Scene> scene = importGltfFromMemory(everything().glb(), "hostile.glb");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(countTriangles(*scene).drawn, 1u);
    EXPECT_EQ(scene->images.size(), 1u);
    EXPECT_EQ(scene->animations.size(), 1u);
    EXPECT_EQ(scene->cameras.size(), 1u);
    EXPECT_EQ(scene->lights.size(), 1u);
    EXPECT_EQ(scene->meshes[0].vertices[2].position, glm::vec3(0.5f, 2, 1.5f));
}

// --- the validator's files ---------------------------------------------------------------------

struct Verdict {
    std::string file;
    int errors = 0;
    std::string codes;
};

std::vector<Verdict> verdicts() {
    std::ifstream table(scenesFolder() / "malformed" / "EXPECTED.tsv");
    std::vector<Verdict> all;
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
        std::istringstream fields(line);
        std::string errors;
        Verdict verdict;
        std::getline(fields, verdict.file, '\t');
        std::getline(fields, errors, '\t');
        std::getline(fields, verdict.codes);
        verdict.errors = std::stoi(errors);
        all.push_back(verdict);
    }
    return all;
}

TEST(HostileGltf, untrueIndexSizeOffsetOrHierarchyIsRefused) {
    REQUIRE_SCENES();
    constexpr const char* kUntrue[] = {"UNRESOLVED_REFERENCE",
                                       "ACCESSOR_TOO_LONG",
                                       "ACCESSOR_SMALL_BYTESTRIDE",
                                       "ACCESSOR_SPARSE_COUNT",
                                       "ACCESSOR_INDEX_",
                                       "ACCESSOR_INVALID_FLOAT",
                                       "JOINTS_INDEX_OOB",
                                       "INVALID_COUNT",
                                       "INVALID_FORMAT",
                                       "BYTE_LENGTH_MISMATCH",
                                       "GLB_",
                                       "BUFFER_MISSING",
                                       "UNEQUAL_ACCESSOR_COUNT",
                                       "WEIGHTS_COUNT",
                                       "NODE_LOOP",
                                       "NODE_PARENT_OVERRIDE",
                                       "SKIN_NO_COMMON_ROOT",
                                       "SKIN_SKELETON_INVALID",
                                       "INVALID_URI",
                                       "UNUSED_EXTENSION_REQUIRED"};
    const std::vector<Verdict> all = verdicts();
    EXPECT_EQ(all.size(), 237u);
    std::size_t refused = 0;
    for (const Verdict& verdict : all) {
        const std::filesystem::path path = scenesFolder() / "malformed" / verdict.file;
        const std::string message = outcome(importGltf(path), path.filename().string());
        const bool untrue = std::any_of(
            std::begin(kUntrue), std::end(kUntrue),
            [&](const char* code) { return verdict.codes.find(code) != std::string::npos; });
        EXPECT_FALSE(untrue && message.empty())
            << verdict.file << " (" << verdict.codes << ") loaded";
        refused += !message.empty();
    }
    EXPECT_GT(refused, 80u);
}

TEST(HostileGltf, validFilesLoad) {
    REQUIRE_SCENES();
    // Valid by themselves, but with buffers that a host program would have to supply, or for a
    // later version of glTF.
    const std::set<std::string> incomplete = {"named_objects.gltf", "unused_objects.gltf",
                                              "min_version_valid.gltf"};
    for (const Verdict& verdict : verdicts()) {
        const std::filesystem::path path = scenesFolder() / "malformed" / verdict.file;
        if (verdict.errors != 0 || incomplete.contains(path.filename().string())) continue;
        EXPECT_EQ(outcome(importGltf(path), path.filename().string()), "") << verdict.file;
    }
}

// --- damage ------------------------------------------------------------------------------------

TEST(HostileGltf, everyTruncationIsRefused) {
    const Bytes file = everything().glb();
    for (std::size_t length = 0; length < file.size(); ++length)
        EXPECT_NE(outcome(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length))),
                  "")
            << length;
}

TEST(HostileGltf, everyFlippedBitLoadsOrIsRefused) {
    const Bytes file = everything().glb();
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < 8 * file.size(); bit += 1 + bit % 3) {
        Bytes damaged = file;
        damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
        refused += !outcome(damaged).empty();
    }
    EXPECT_GT(refused, file.size());  // most bits are JSON
}

TEST(HostileGltf, everyNumberMadeAbsurdLoadsOrIsRefused) {
    const GltfBuilder good = everything();
    const nlohmann::json flat = good.json.flatten();
    for (const auto& [path, value] : flat.items()) {
        for (const nlohmann::json& absurd :
             {nlohmann::json(4294967295u), nlohmann::json(18446744073709551615ull),
              nlohmann::json(-1), nlohmann::json(1e38), nlohmann::json(0.5), nlohmann::json(),
              nlohmann::json("text"), nlohmann::json::array(), nlohmann::json::object()}) {
            GltfBuilder bad = good;
            bad.json[nlohmann::json::json_pointer(path)] = absurd;
            outcome(bad);
        }
    }
}

// --- lies --------------------------------------------------------------------------------------

TEST(HostileGltf, absurdCountsAllocateNothing) {
    for (const std::uint64_t count :
         {4294967295ull, 9007199254740992ull, 18446744073709551615ull}) {
        GltfBuilder builder;
        builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
        builder.json["accessors"][0]["count"] = count;
        expectRefusedAt(builder, "/accessors/0/count");
        builder.json["accessors"][0].erase("bufferView");
        expectRefusedAt(builder, "/accessors/0/count");
    }
}

TEST(HostileGltf, offsetsThatWrapAroundAreRefused) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.json["accessors"][0]["byteOffset"] = 18446744073709551615ull;
    expectRefusedAt(builder, "/accessors/0/byteOffset");
    builder.json["accessors"][0]["byteOffset"] = 4;
    expectRefusedAt(builder, "/accessors/0");
    builder.json["accessors"][0].erase("byteOffset");
    builder.json["bufferViews"][0]["byteLength"] = 4294967295u;
    expectRefusedAt(builder, "/bufferViews/0");
}

TEST(HostileGltf, indexOutOfRangeIsRefused) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}})["indices"] =
        builder.shorts({0, 1, 3});
    EXPECT_EQ(outcome(builder),
              "hostile.glb: /meshes/0/primitives/0/indices: index 3 is not below the number of "
              "vertices (3); export it again");
}

TEST(HostileGltf, sparseIndexOutOfRangeIsRefused) {
    GltfBuilder builder = everything();
    builder.bin[builder.json["bufferViews"][6]["byteOffset"].get<std::size_t>()] = 3;
    expectRefusedAt(builder, "/accessors/5/sparse/indices");
}

TEST(HostileGltf, positionsThatAreNotFiniteAreRefused) {
    for (const float bad :
         {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        GltfBuilder builder;
        std::vector<float> positions = kTriangle;
        positions[4] = bad;
        builder.show({{"POSITION", builder.floats(positions, "VEC3")}});
        EXPECT_EQ(outcome(builder),
                  "hostile.glb: /accessors/0: element 1 is not finite; export it again");
    }
}

TEST(HostileGltf, transformsThatOverflowAreRefused) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.json["nodes"][0]["scale"] = {1e30, 1, 1};
    builder.add("nodes", {{"children", {0}}, {"scale", {1e30, 1, 1}}});
    expectRefusedAt(builder, "/nodes/0");
    builder.json["nodes"][1]["scale"] = {1, 1, 1};
    expectRefusedAt(builder, "/nodes");
}

TEST(HostileGltf, cyclesAndSecondParentsAreRefused) {
    GltfBuilder builder;
    for (const int child : {1, 2, 0}) builder.add("nodes", {{"children", {child}}});
    expectRefusedAt(builder, "/nodes/0");
    builder.json["nodes"] = {{{"children", {0}}}};
    expectRefusedAt(builder, "/nodes/0");
    builder.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, nlohmann::json::object()};
    expectRefusedAt(builder, "/nodes/1/children/0");
    builder.json["nodes"] = {{{"children", {1}}}, nlohmann::json::object()};
    builder.json["scenes"] = {{{"nodes", {1}}}};
    expectRefusedAt(builder, "/scenes/0/nodes/0");
}

TEST(HostileGltf, chainOfAHundredThousandNodesLoads) {
    constexpr int kNodes = 100000;
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.json["nodes"] = nlohmann::json::array();
    for (int i = 0; i + 1 < kNodes; ++i)
        builder.json["nodes"].push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
    builder.json["nodes"].push_back({{"mesh", 0}});
    const Result<Scene> scene = importGltfFromMemory(builder.glb(), "hostile.glb");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(worldFromNode(*scene)[scene->instances.at(0).node][3].x, kNodes - 1);
}

TEST(HostileGltf, deepJsonIsRefused) {
    const std::string deep(200000, '[');
    EXPECT_NE(outcome(R"({"asset":{"version":"2.0"},"extras":)" + deep), "");
    EXPECT_NE(outcome(deep).find("nested"), std::string::npos);
}

TEST(HostileGltf, repetitionEndsAtABudget) {
    // Few bytes ask for much: 3000 meshes of the same 3000 triangles, and so on.
    const auto timed = [](const GltfBuilder& builder) {
        const auto start = std::chrono::steady_clock::now();
        const std::string message = outcome(builder);
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
        return message;
    };
    GltfBuilder primitives;
    const std::size_t position = primitives.floats(std::vector<float>(9000, 1.0f), "VEC3");
    primitives.show({{"POSITION", position}});
    for (int i = 0; i < 30000; ++i)
        primitives.json["meshes"][0]["primitives"].push_back(
            {{"attributes", {{"POSITION", position}}}});
    EXPECT_NE(timed(primitives).find("far more than the file's size"), std::string::npos);

    GltfBuilder instances;
    instances.show({{"POSITION", instances.floats(kTriangle, "VEC3")}});
    const std::size_t places = instances.floats(std::vector<float>(30000, 1.0f), "VEC3");
    for (int i = 0; i < 5000; ++i)
        instances.add(
            "nodes",
            {{"mesh", 0},
             {"extensions",
              {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
    EXPECT_NE(timed(instances).find("far more than the file's size"), std::string::npos);

    GltfBuilder materials;
    materials.json["materials"] =
        nlohmann::json(std::vector<nlohmann::json>(300000, nlohmann::json::object()));
    EXPECT_NE(timed(materials).find("far more than the file's size"), std::string::npos);

    GltfBuilder accessors;
    const std::size_t view = accessors.view(std::vector<float>(250000, 1.0f));
    for (int i = 0; i < 20000; ++i) accessors.accessor(view, 5126, "SCALAR", 250000);
    EXPECT_NE(timed(accessors).find("far more than the file's size"), std::string::npos);
}

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
    EXPECT_NE(imageOutcome(pngHeader(20000, 1)).find("20000 x 1 pixels are over the limit"),
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
