// SPDX-License-Identifier: Apache-2.0
// The importer on the files of others: the scenes, and the Khronos samples.
#include <array>
#include <map>

#include <lodestar/scene/deform_reference.hpp>
#include <lodestar/scene/import.hpp>
#include <lodestar/scene/tangents.hpp>

#include "gltf_import.hpp"

namespace lodestar::scene {
namespace {

struct Counts {
    const char* file;
    std::uint64_t stored, drawn;
};

// "drawn" and, where no geometry is shared between materials, "stored" as in the table that comes
// with the scenes. That table counts shared geometry once; here each material has its own copy.
constexpr Counts kScenes[] = {
    {"sponza.glb", 262267, 262267},
    {"littlest_tokyo.glb", 141802, 141802},
    {"chess_abeautifulgame.glb", 565848, 1430784},  // 329,132 unique: two colours of pieces
    {"stanford_dragon_res2.glb", 202520, 202520},
    {"toy_car.glb", 108936, 108936},
    {"lamborghini.glb", 145917, 145917},
    {"radial_engine.glb", 105877, 105877},
    {"tree_ez_oak.glb", 22566, 22566},
    {"tree_ez_pine.glb", 19392, 19392},
    {"tree_lowpoly_leaves.glb", 778, 778},
    {"room_interior.glb", 47402, 47402},
    {"flight_helmet.glb", 94722, 94722},
    {"water_bottle.glb", 4510, 4510},
    {"tests/AlphaBlendModeTest.glb", 61, 61},
    {"tests/NormalTangentTest.glb", 7774, 7774},
    {"tests/TextureSettingsTest.glb", 72, 72},
    {"tests/OrientationTest.glb", 524, 524},
    {"tests/VertexColorTest.glb", 36, 36},
    {"tests/MorphStressTest.glb", 2412, 2412},
    {"tests/SimpleInstancing.glb", 12, 1500},
    {"tests/MeshPrimitiveModes/MeshPrimitiveModes.gltf", 16, 16},
    {"tests/BoxInterleaved.glb", 12, 12},
    {"tests/SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12, 12},
    {"tests/InterpolationTest.glb", 110, 110},
    {"tests/RiggedFigure.glb", 256, 256},
    {"tests/CesiumMan.glb", 4672, 4672},
    {"tests/Fox.glb", 576, 576},
    {"tests/MultiUVTest.glb", 12, 12},
    {"tests/TextureTransformTest/TextureTransformTest.gltf", 18, 24},  // 2 unique, 9 materials
    {"tests/BoxTexturedNonPowerOfTwo/BoxTexturedNonPowerOfTwo.gltf", 12, 12},
    {"tests/Cameras/Cameras.gltf", 2, 2},
    {"tests/Box With Spaces/Box With Spaces.gltf", 12, 12},
    {"tests/TextureCoordinateTest/TextureCoordinateTest.gltf", 10, 10},
};

// Drawn as in the table; stored differs because geometry is shared or not in any node.
constexpr Counts kSharing[] = {
    {"city_kaykit.glb", 15711, 1652956},
    {"godot_truck_town.glb", 31403, 36167},
    {"dungeon_kaykit.glb", 47755, 702912},
    {"glass_vase_flowers.glb", 7018, 14036},
    {"tests/NegativeScaleTest.glb", 1324, 0},
    {"tests/TextureEncodingTest.glb", 322, 0},
    {"tests/MetalRoughSpheresNoTextures.glb", 12209, 0},
};

TEST(ImportGltf, scenesHaveTheTrianglesOfTheirTable) {
    REQUIRE_SCENES();
    for (const Counts& expected : kScenes) {
        SCOPED_TRACE(expected.file);
        const Scene scene = imported(scenesFolder() / expected.file);
        const TriangleCounts counts = countTriangles(scene);
        EXPECT_EQ(counts.stored, expected.stored);
        EXPECT_EQ(counts.drawn, expected.drawn);
        expectSound(scene);
    }
    for (const Counts& expected : kSharing) {
        SCOPED_TRACE(expected.file);
        const Scene scene = imported(scenesFolder() / expected.file);
        const TriangleCounts counts = countTriangles(scene);
        EXPECT_GE(counts.stored, expected.stored);
        if (expected.drawn != 0) {
            EXPECT_EQ(counts.drawn, expected.drawn);
        }
        expectSound(scene);
    }
}

void expectSize(const char* file, glm::vec3 size, glm::vec3 centre) {
    const Scene scene = imported(scenesFolder() / file);
    const Bounds bounds = worldBounds(scene, worldFromNode(scene));
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(bounds.upper[i] - bounds.lower[i], size[i], 0.01f * size[i]) << file;
        EXPECT_NEAR(bounds.centre()[i], centre[i], 0.01f * glm::length(size)) << file;
    }
}

TEST(ImportGltf, scenesHaveTheSizesOfTheirTable) {
    REQUIRE_SCENES();
    expectSize("sponza.glb", {29.8, 12.4, 18.3}, {-0.48, 5.21, -0.31});
    expectSize("littlest_tokyo.glb", {545, 434, 552}, {-86.6, 5.65, -25.6});
    expectSize("godot_truck_town.glb", {2048, 28.2, 2048}, {0, 9.47, 0});
    expectSize("radial_engine.glb", {64.0, 51.0, 60.8}, {-3.41, -19.1, -1.00});
}

TEST(ImportGltf, sponzaHasItsTexturesInBothColourSpaces) {
    REQUIRE_SCENES();
    const Scene scene = imported(scenesFolder() / "sponza.glb");
    EXPECT_EQ(scene.images.size(), 67u);
    for (const Material& material : scene.materials) {
        const std::uint32_t color = material.baseColorTexture.texture;
        const std::uint32_t normal = material.normalTexture.texture;
        EXPECT_TRUE(color == kNone || scene.textures[color].space == ColorSpace::srgb);
        EXPECT_TRUE(normal == kNone || scene.textures[normal].space == ColorSpace::linear);
    }
    const auto masked = [](const Material& m) { return m.alphaMode == AlphaMode::mask; };
    EXPECT_GT(std::count_if(scene.materials.begin(), scene.materials.end(), masked), 0);
}

TEST(ImportGltf, sparseAccessorReplacesElements) {
    REQUIRE_SCENES();
    const Scene scene = sample("SimpleSparseAccessor/SimpleSparseAccessor.gltf");
    ASSERT_EQ(scene.meshes.size(), 1u);
    // The sparse positions raise vertices 8, 10 and 12 of the upper row (see the sample's text).
    std::vector<glm::vec3> positions;
    for (const Vertex& vertex : scene.meshes[0].vertices) positions.push_back(vertex.position);
    for (const glm::vec3 raised : {glm::vec3(1, 2, 0), glm::vec3(3, 3, 0), glm::vec3(5, 4, 0)})
        EXPECT_NE(std::find(positions.begin(), positions.end(), raised), positions.end());
}

TEST(ImportGltf, textureTransformHitsTheSamplesMarkers) {
    REQUIRE_SCENES();
    const Scene scene = sample("TextureTransformTest/TextureTransformTest.gltf");
    // The arrow's tip in the image, and where each quad's marker for "correct" is.
    const glm::vec2 tip(0.5f + 0.2778174593f, 0.5f + 0.2778174593f);
    const std::map<std::string, glm::vec2> markers = {{"Rotation", {-0.0790482f, -0.5162675f}},
                                                      {"Scale", {0.0185450f, -0.0185450f}},
                                                      {"All", {-0.07f, -0.25f}}};
    for (const auto& [name, marker] : markers) {
        const glm::vec2 uv(0.5f + marker.x, 0.5f - marker.y);
        const glm::vec2 hit =
            materialNamed(scene, name).baseColorTexture.transform * glm::vec3(uv, 1);
        EXPECT_NEAR(hit.x, tip.x, name == "All" ? 0.05f : 1e-4f) << name;
        EXPECT_NEAR(hit.y, tip.y, name == "All" ? 0.05f : 1e-4f) << name;
    }
    EXPECT_EQ(materialNamed(scene, "Offset U").baseColorTexture.transform[2], glm::vec2(0.5f, 0));
    EXPECT_EQ(materialNamed(scene, "Correct").baseColorTexture.transform,
              glm::mat3x2(1, 0, 0, 1, 0, 0));
}

TEST(ImportGltf, interleavedAttributesAreReadByStride) {
    REQUIRE_SCENES();
    const Scene scene = sample("BoxInterleaved.glb");
    ASSERT_EQ(scene.meshes.size(), 1u);
    for (const Vertex& vertex : scene.meshes[0].vertices) {
        EXPECT_EQ(glm::abs(vertex.position), glm::vec3(0.5f));
        // A box corner's normal is that of one of its three faces, pointing outwards.
        EXPECT_FLOAT_EQ(glm::dot(vertex.normal, vertex.position), 0.5f);
    }
}

TEST(ImportGltf, allTriangleModesFaceTheSameWay) {
    REQUIRE_SCENES();
    const Scene scene = sample("MeshPrimitiveModes/MeshPrimitiveModes.gltf");
    ASSERT_EQ(scene.meshes.size(),
              3u);  // list, strip, fan; points and three kinds of lines are not
    EXPECT_TRUE(notes(scene, "4 primitives of points or lines"));
    for (const Mesh& mesh : scene.meshes)
        for (const Vertex& vertex : mesh.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
}

TEST(ImportGltf, negativeScaleStaysInTheInstance) {
    REQUIRE_SCENES();
    const Scene scene = sample("NegativeScaleTest.glb");
    const std::vector<glm::mat4> world = worldFromNode(scene);
    const auto mirrored = [&](const Instance& instance) {
        return glm::determinant(world[instance.node] * instance.nodeFromObject) < 0;
    };
    EXPECT_GT(std::count_if(scene.instances.begin(), scene.instances.end(), mirrored), 0);
}

TEST(ImportGltf, vertexColoursAreRead) {
    REQUIRE_SCENES();
    const Scene scene = sample("VertexColorTest.glb");
    std::size_t coloured = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const Vertex& vertex : mesh.vertices) coloured += vertex.color != glm::vec4(1);
    EXPECT_GT(coloured, 0u);
}

TEST(ImportGltf, secondUvSetIsKeptApart) {
    REQUIRE_SCENES();
    const Scene scene = sample("MultiUVTest.glb");
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].baseColorTexture.uvSet + scene.materials[0].emissiveTexture.uvSet,
              1u);
    std::size_t different = 0;
    for (const Vertex& vertex : scene.meshes[0].vertices) different += vertex.uv0 != vertex.uv1;
    EXPECT_GT(different, 0u);
}

TEST(ImportGltf, camerasAreReadAndOrthographicOnesApproximated) {
    REQUIRE_SCENES();
    const Scene scene = sample("Cameras/Cameras.gltf");
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_FLOAT_EQ(scene.cameras[0].verticalFov, 0.7f);
    EXPECT_FLOAT_EQ(scene.cameras[0].nearPlane, 0.01f);
    // ymag 1 seen from (0.5, 0.5, 3): as high as the perspective view at the scene's middle.
    EXPECT_NEAR(scene.cameras[1].verticalFov, 2 * std::atan(1 / 3.36f), 0.01f);
    EXPECT_TRUE(notes(scene, "1 orthographic cameras"));
}

TEST(ImportGltf, gpuInstancesHaveTheirOwnTransforms) {
    REQUIRE_SCENES();
    const Scene scene = sample("SimpleInstancing.glb");
    ASSERT_EQ(scene.instances.size(), 125u);
    std::map<std::array<int, 3>, int> places;
    for (const Instance& instance : scene.instances) {
        const glm::vec3 place = instance.nodeFromObject[3];
        ++places[{static_cast<int>(std::lround(place.x * 100)),
                  static_cast<int>(std::lround(place.y * 100)),
                  static_cast<int>(std::lround(place.z * 100))}];
    }
    EXPECT_EQ(places.size(), 125u);
}

TEST(ImportGltf, skinnedFiguresStandUpright) {
    REQUIRE_SCENES();
    // As other viewers show them at rest: CesiumMan is 1.5 m tall on the ground, the fox 79 units.
    for (const auto& [file, height] :
         {std::pair{"CesiumMan.glb", 1.507f}, {"Fox.glb", 79.03f}, {"RiggedFigure.glb", 1.45f}}) {
        Scene scene = sample(file);
        scene.animations.clear();
        const Pose rest = poseAt(scene);
        Bounds box;
        for (const Instance& instance : scene.instances) {
            EXPECT_TRUE(deforms(scene, instance)) << file;
            for (const DeformedVertex& v : deformReference(scene, instance, rest))
                box.add(glm::vec3(v.position));
        }
        EXPECT_NEAR(box.lower.y, 0, 0.02f * height) << file;
        EXPECT_NEAR(box.upper.y, height, 0.01f * height) << file;
        // Those that are known without looking at the vertices hold them, and not much more.
        const Bounds bounds = worldBounds(scene, rest);
        EXPECT_EQ(glm::min(bounds.lower, box.lower), bounds.lower) << file;
        EXPECT_EQ(glm::max(bounds.upper, box.upper), bounds.upper) << file;
        EXPECT_LT(bounds.radius(), 1.5f * box.radius()) << file;
    }
}

TEST(ImportGltf, namesWithSpacesAreFound) {
    REQUIRE_SCENES();
    EXPECT_EQ(sample("Box With Spaces/Box With Spaces.gltf").images.size(), 3u);
}

TEST(ImportGltf, wrapModesAreKept) {
    REQUIRE_SCENES();
    const Scene scene = sample("TextureSettingsTest.glb");
    const auto uses = [&](Wrap wrap) {
        return std::any_of(scene.textures.begin(), scene.textures.end(),
                           [&](const Texture& t) { return t.wrapU == wrap || t.wrapV == wrap; });
    };
    EXPECT_TRUE(uses(Wrap::repeat));
    EXPECT_TRUE(uses(Wrap::mirroredRepeat));
    EXPECT_TRUE(uses(Wrap::clampToEdge));
    EXPECT_TRUE(std::any_of(scene.materials.begin(), scene.materials.end(),
                            [](const Material& material) { return material.doubleSided; }));
}

TEST(ImportGltf, alphaModesAreKept) {
    REQUIRE_SCENES();
    const Scene scene = sample("AlphaBlendModeTest.glb");
    std::vector<float> cutoffs;
    for (const Material& material : scene.materials)
        if (material.alphaMode == AlphaMode::mask) cutoffs.push_back(material.alphaCutoff);
    std::sort(cutoffs.begin(), cutoffs.end());
    EXPECT_EQ(cutoffs, (std::vector<float>{0.25f, 0.5f, 0.75f}));
    EXPECT_TRUE(std::any_of(scene.materials.begin(), scene.materials.end(),
                            [](auto& m) { return m.alphaMode == AlphaMode::blend; }));
}

TEST(ImportGltf, generatedTangentsAgreeWithTheFilesOwn) {
    REQUIRE_SCENES();
    // Tools differ in weights and in splitting, so that single vertices may disagree. (Not Sponza:
    // its tangents have the directions generated here and w reversed throughout.)
    for (const char* file : {"water_bottle.glb", "flight_helmet.glb"}) {
        Scene scene = imported(scenesFolder() / file);
        std::size_t total = 0, alike = 0;
        for (Mesh& mesh : scene.meshes) {
            const Mesh original = mesh;
            generateTangents(mesh);
            for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
                const Vertex& own = original.vertices[original.indices[i]];
                const Vertex& made = mesh.vertices[mesh.indices[i]];
                EXPECT_NEAR(glm::dot(made.normal, glm::vec3(made.tangent)), 0, 1e-3f);
                ++total;
                alike += own.tangent.w == made.tangent.w &&
                         glm::dot(glm::vec3(own.tangent), glm::vec3(made.tangent)) > 0.9f;
            }
        }
        EXPECT_GT(static_cast<double>(alike), 0.95 * static_cast<double>(total)) << file;
    }
}

}  // namespace
}  // namespace lodestar::scene
