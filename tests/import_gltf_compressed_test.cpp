// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <meshoptimizer.h>

#include "gltf_import.hpp"

namespace lodestar::scene {
namespace {

/// A wavy grid of n × n vertices.
void makeGrid(std::size_t n, std::vector<float>& positions, std::vector<unsigned>& indices) {
    for (std::size_t y = 0; y < n; ++y)
        for (std::size_t x = 0; x < n; ++x) {
            positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y),
                                               static_cast<float>((x * 7 + y * 3) % 5)});
            if (x + 1 == n || y + 1 == n) continue;
            const auto i = static_cast<unsigned>(y * n + x), down = static_cast<unsigned>(i + n);
            indices.insert(indices.end(), {i, i + 1, down, down, i + 1, down + 1});
        }
}

/// Replaces the view by one whose bytes exist only in compressed form.
void compress(GltfBuilder& builder, std::size_t view, const std::vector<std::uint8_t>& encoded,
              std::size_t stride, std::size_t count, const char* mode, const char* filter) {
    const std::size_t packed = builder.view(encoded);
    nlohmann::json extension = builder.json["bufferViews"][packed];
    builder.json["bufferViews"].erase(packed);
    extension.update(
        {{"byteStride", stride}, {"count", count}, {"mode", mode}, {"filter", filter}});
    builder.json["bufferViews"][view] = {{"buffer", 1},
                                         {"byteLength", stride * count},
                                         {"extensions", {{"EXT_meshopt_compression", extension}}}};
    if (std::string(mode) == "ATTRIBUTES") builder.json["bufferViews"][view]["byteStride"] = stride;
    builder.json["buffers"][1] = {
        {"byteLength", 1 << 20},
        {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}};
}

std::vector<std::uint8_t> encodedVertices(const void* data, std::size_t count, std::size_t size) {
    std::vector<std::uint8_t> bytes(meshopt_encodeVertexBufferBound(count, size));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), data, count, size));
    return bytes;
}

TEST(ImportGltf, meshoptCompressedMeshIsDecoded) {
    constexpr std::size_t kSide = 20, kCount = kSide * kSide;
    std::vector<float> positions;
    std::vector<unsigned> indices;
    makeGrid(kSide, positions, indices);
    // Normals as 8-bit octahedral, positions with the exponential filter.
    std::vector<float> normals;
    for (std::size_t i = 0; i < kCount; ++i) normals.insert(normals.end(), {0.6f, 0, 0.8f, 0});
    std::vector<std::uint8_t> octahedral(4 * kCount);
    meshopt_encodeFilterOct(octahedral.data(), kCount, 4, 8, normals.data());
    std::vector<std::uint32_t> exponential(3 * kCount);
    meshopt_encodeFilterExp(exponential.data(), kCount, 12, 20, positions.data());
    std::vector<std::uint8_t> triangles(meshopt_encodeIndexBufferBound(indices.size(), kCount));
    triangles.resize(meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices.data(),
                                               indices.size()));
    GltfBuilder builder;
    const std::vector<std::uint8_t> nothing;
    const std::size_t position = builder.view(nothing), normal = builder.view(nothing),
                      index = builder.view(nothing);
    compress(builder, position, encodedVertices(exponential.data(), kCount, 12), 12, kCount,
             "ATTRIBUTES", "EXPONENTIAL");
    compress(builder, normal, encodedVertices(octahedral.data(), kCount, 4), 4, kCount,
             "ATTRIBUTES", "OCTAHEDRAL");
    compress(builder, index, triangles, 2, indices.size(), "TRIANGLES", "NONE");
    builder.show({{"POSITION", builder.accessor(position, 5126, "VEC3", kCount)},
                  {"NORMAL", builder.accessor(normal, 5120, "VEC3", kCount, true)}})["indices"] =
        builder.accessor(index, 5123, "SCALAR", indices.size());
    builder.json["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};

    const Scene scene = built(builder);
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.indices.size(), indices.size());
    for (std::size_t i = 0; i < kCount; ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(mesh.vertices[i].position[c],
                        positions[3 * i + static_cast<std::size_t>(c)], 1e-3f);
    EXPECT_NEAR(mesh.vertices[0].normal.x, 0.6f, 0.02f);
    EXPECT_NEAR(mesh.vertices[0].normal.z, 0.8f, 0.02f);
    // The codec may turn a triangle's corners around, but not drop or reverse it.
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        std::array<unsigned, 3> expected = {indices[t], indices[t + 1], indices[t + 2]};
        std::array<unsigned, 3> found = {mesh.indices[t], mesh.indices[t + 1], mesh.indices[t + 2]};
        std::rotate(expected.begin(), std::min_element(expected.begin(), expected.end()),
                    expected.end());
        std::rotate(found.begin(), std::min_element(found.begin(), found.end()), found.end());
        EXPECT_EQ(expected, found);
    }

    // One byte less of the compressed triangles is damage, not a crash.
    builder.json["bufferViews"][index]["extensions"]["EXT_meshopt_compression"]["byteLength"] =
        triangles.size() - 1;
    EXPECT_NE(refusal(builder).find("/bufferViews/2/extensions/EXT_meshopt_compression"),
              std::string::npos);
}

TEST(ImportGltf, dracoModelEqualsItsUncompressedCounts) {
    const std::filesystem::path models = "/usr/share/assimp/models/glTF2";
    const std::filesystem::path file = models / "draco" / "2CylinderEngine.gltf";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "install assimp-testmodels";
    const Scene scene = imported(file);
    // A third of the sum of the counts of its index accessors.
    EXPECT_EQ(countTriangles(scene).stored, 65311u);
    // The same engine, stored plainly.
    const Scene plain = imported(models / "2CylinderEngine-glTF-Binary" / "2CylinderEngine.glb");
    const Bounds box = worldBounds(scene, worldFromNode(scene));
    const Bounds plainBox = worldBounds(plain, worldFromNode(plain));
    EXPECT_EQ(scene.instances.size(), plain.instances.size());
    EXPECT_LT(glm::distance(box.lower, plainBox.lower), 0.5f);
    EXPECT_LT(glm::distance(box.upper, plainBox.upper), 0.5f);
    expectSound(scene);
}

}  // namespace
}  // namespace lodestar::scene
