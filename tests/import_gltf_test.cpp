// SPDX-License-Identifier: Apache-2.0
// The importer on files built in memory; import_gltf_*_test.cpp have the others.
#include <lodestar/scene/tangents.hpp>

#include "gltf_import.hpp"

namespace lodestar::scene {
namespace {

TEST(ImportGltf, triangleComesOutAsItWentIn) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")},
                  {"TEXCOORD_0", builder.floats({0, 1, 1, 1, 0, 0}, "VEC2")}})["indices"] =
        builder.shorts({0, 1, 2});
    const Scene scene = built(builder);
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(mesh.vertices[1].position, glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh.vertices[1].uv0, glm::vec2(1, 1));
    EXPECT_EQ(mesh.vertices[1].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.bounds.upper, glm::vec3(1, 1, 0));
    EXPECT_EQ(scene.name, "built.glb");
    EXPECT_EQ(scene.materials.at(mesh.material).metallic, 1);  // glTF's default material
    expectSound(scene);
}

TEST(ImportGltf, missingNormalsAreFlat) {
    GltfBuilder builder;  // two faces of a roof over a shared ridge
    builder.show(
        {{"POSITION", builder.floats({0, 0, 0, 0, 0, 1, 1, 1, 0, 2, 0, 0}, "VEC3")}})["indices"] =
        builder.shorts({0, 1, 2, 2, 1, 3});
    const Mesh mesh = built(builder).meshes.at(0);
    ASSERT_EQ(mesh.vertices.size(), 6u);
    for (std::size_t t = 0; t < 2; ++t) {
        const glm::vec3 a = mesh.vertices[mesh.indices[3 * t]].position;
        const glm::vec3 b = mesh.vertices[mesh.indices[3 * t + 1]].position;
        const glm::vec3 c = mesh.vertices[mesh.indices[3 * t + 2]].position;
        const glm::vec3 face = glm::normalize(glm::cross(b - a, c - a));
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_GT(glm::dot(mesh.vertices[mesh.indices[3 * t + k]].normal, face), 0.9999f);
    }
}

TEST(ImportGltf, zeroNormalsBecomeFaceNormals) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")},
                  {"NORMAL", builder.floats({0, 0, 0, 1e-42f, 0, 0, 0, 3, 0}, "VEC3")}});
    const Mesh mesh = built(builder).meshes.at(0);
    EXPECT_EQ(mesh.vertices[0].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.vertices[1].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.vertices[2].normal, glm::vec3(0, 1, 0));
}

TEST(ImportGltf, stripsAndFansKeepTheirWinding) {
    for (const int mode : {5, 6}) {
        GltfBuilder builder;
        // A strip zigzags, a fan goes around.
        const std::vector<float> strip = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        const std::vector<float> fan = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
        builder.show({{"POSITION", builder.floats(mode == 5 ? strip : fan, "VEC3")}})["mode"] =
            mode;
        const Mesh mesh = built(builder).meshes.at(0);
        EXPECT_EQ(mesh.indices.size(), 6u);
        for (const Vertex& vertex : mesh.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
    }
}

TEST(ImportGltf, quantisedAttributesAreScaled) {
    GltfBuilder builder;
    const std::vector<std::int16_t> positions = {0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0};
    const std::vector<std::int8_t> normals = {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
    const std::vector<std::uint8_t> colors = {255, 0, 51, 255, 255, 0, 51, 255, 255, 0, 51, 255};
    const std::size_t position = builder.view(positions), normal = builder.view(normals);
    builder.json["bufferViews"][position]["byteStride"] = 8;
    builder.json["bufferViews"][normal]["byteStride"] = 4;
    builder.show({{"POSITION", builder.accessor(position, 5122, "VEC3", 3, true)},
                  {"NORMAL", builder.accessor(normal, 5120, "VEC3", 3, true)},
                  {"COLOR_0", builder.accessor(builder.view(colors), 5121, "VEC4", 3, true)}});
    builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Mesh mesh = built(builder).meshes.at(0);
    EXPECT_EQ(mesh.vertices[1].position, glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh.vertices[2].position, glm::vec3(0, -1, 0));
    EXPECT_EQ(mesh.vertices[0].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.vertices[0].color, glm::vec4(1, 0, 0.2f, 1));
}

TEST(ImportGltf, onlyTheDefaultSceneIsRead) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.add("nodes", {{"children", {2}}, {"translation", {5, 0, 0}}});
    builder.add("nodes", {{"mesh", 0}, {"name", "child"}});
    builder.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    EXPECT_EQ(built(builder).nodes.size(), 1u);
    builder.json["scene"] = 1;
    const Scene scene = built(builder);
    ASSERT_EQ(scene.nodes.size(), 2u);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.nodes[scene.instances[0].node].name, "child");
    EXPECT_EQ(worldFromNode(scene)[scene.instances[0].node][3].x, 5);
    builder.json.erase("scenes");
    builder.json.erase("scene");
    EXPECT_EQ(built(builder).nodes.size(), 3u);
}

TEST(ImportGltf, invisibleSubtreesAreLeftOut) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.add("nodes", {{"mesh", 0},
                          {"children", {2}},
                          {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
    builder.add("nodes", {{"mesh", 0}});
    const Scene scene = built(builder);
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(notes(scene, "2 nodes are invisible"));
}

TEST(ImportGltf, skinTakesThePlaceOfTheNode) {
    GltfBuilder builder;
    std::vector<float> bind(16, 0.0f);
    for (std::size_t i = 0; i < 4; ++i) bind[5 * i] = 1;
    bind[12] = -10;  // the joint was bound at x = 10
    const std::vector<std::uint8_t> joints(12, 0);
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")},
                  {"NORMAL", builder.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
                  {"JOINTS_0", builder.accessor(builder.view(joints), 5121, "VEC4", 3)},
                  {"WEIGHTS_0", builder.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4")}});
    builder.json["nodes"][0]["skin"] = 0;
    builder.json["nodes"][0]["translation"] = {100, 100, 100};
    const float half = std::sqrt(0.5f);  // the joint: at x = 12, turned 90° about x
    builder.add("nodes", {{"translation", {12, 0, 0}}, {"rotation", {half, 0, 0, half}}});
    builder.add("skins", {{"joints", {1}}, {"inverseBindMatrices", builder.floats(bind, "MAT4")}});
    const Scene scene = built(builder);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(worldFromNode(scene)[scene.instances[0].node], glm::mat4(1));
    const Mesh& mesh = scene.meshes[0];
    EXPECT_NEAR(mesh.vertices[1].position.x, 3, 1e-5f);  // (1 − 10) + 12
    EXPECT_NEAR(mesh.vertices[2].position.z, 1, 1e-5f);  // y became z
    EXPECT_NEAR(mesh.vertices[0].normal.y, -1, 1e-5f);   // z became −y
    EXPECT_FALSE(mesh.deforms());                        // nothing moves its joint
}

TEST(ImportGltf, morphTargetsApplyAtTheirRestWeights) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}})["targets"] = {
        {{"POSITION", builder.floats({0, 0, 4, 0, 0, 4, 0, 0, 4}, "VEC3")}}};
    builder.json["meshes"][0]["weights"] = {0.5};
    builder.add("nodes", {{"mesh", 0}, {"weights", {0.25}}});
    const Scene scene = built(builder);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].vertices[0].position.z, 2);
    EXPECT_EQ(scene.meshes[1].vertices[0].position.z, 1);  // the node's own weights
    EXPECT_FALSE(scene.meshes[0].deforms());               // nothing moves its weights
}

TEST(ImportGltf, materialExtensionsAreApplied) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}})["material"] = 0;
    builder.add("materials",
                {{"emissiveFactor", {1, 0.5, 0}},
                 {"doubleSided", true},
                 {"pbrMetallicRoughness",
                  {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"roughnessFactor", 0.25}}},
                 {"extensions",
                  {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}},
                   {"KHR_materials_unlit", nlohmann::json::object()},
                   {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}}}});
    builder.json["extensionsUsed"] = {"KHR_materials_unlit", "KHR_materials_clearcoat"};
    const Scene scene = built(builder);
    const Material& material = scene.materials.at(scene.meshes.at(0).material);
    EXPECT_EQ(material.emissive, glm::vec3(4, 2, 0));
    EXPECT_EQ(material.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(material.roughness, 0.25f);
    EXPECT_EQ(material.metallic, 1);
    EXPECT_TRUE(material.unlit);
    EXPECT_TRUE(material.doubleSided);
    EXPECT_TRUE(notes(scene, "KHR_materials_clearcoat: not supported"));
    EXPECT_FALSE(notes(scene, "unlit"));
}

TEST(ImportGltf, unsupportedRequiredExtensionIsNamed) {
    GltfBuilder builder;
    builder.json["extensionsRequired"] = {"KHR_texture_transform", "KHR_texture_basisu"};
    EXPECT_EQ(refusal(builder),
              "built.glb: /extensionsRequired/1: requires KHR_texture_basisu, which is not "
              "supported; export it without that extension");
}

TEST(ImportGltf, lightsAreRead) {
    GltfBuilder builder;
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", 7}, {"range", 3}, {"color", {1, 0.5, 0}}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}};
    for (const int light : {1, 0})
        builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
    const Scene scene = built(builder);
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].kind, LightKind::spot);
    EXPECT_EQ(scene.lights[0].outerCone, 0.2f);
    EXPECT_EQ(scene.lights[1].kind, LightKind::point);
    EXPECT_EQ(scene.lights[1].intensity, 7);
    EXPECT_EQ(scene.lights[1].range, 3);
    EXPECT_EQ(scene.lights[1].color, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(scene.lights[1].node, 1u);
}

// A 2×2 PNG of 4 palette entries: red, green / blue, half-transparent white.
const std::string kPalettedPng =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAMAAABFaP0WAAAADFBMVEX/AAAA/wAAAP/////7AGD2AAAABHRSTlP///+A"
    "rZIq1AAAAA5JREFUeJxjYGBkYGIGAAARAAeeoioSAAAAAElFTkSuQmCC";

TEST(ImportGltf, oneImageReadInTwoWaysIsTwoTextures) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}})["material"] = 0;
    builder.add("images", {{"uri", kPalettedPng}});
    builder.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
    builder.add("textures", {{"source", 0}, {"sampler", 0}});
    builder.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                              {"emissiveTexture", {{"index", 0}}},
                              {"occlusionTexture", {{"index", 0}, {"strength", 0.5}}}});
    const Scene scene = built(builder);
    ASSERT_EQ(scene.images.size(), 1u);
    ASSERT_EQ(scene.textures.size(), 2u);
    const Material& material = scene.materials.at(0);
    EXPECT_EQ(material.baseColorTexture.texture, material.emissiveTexture.texture);
    EXPECT_NE(material.baseColorTexture.texture, material.occlusionTexture.texture);
    EXPECT_EQ(material.occlusionStrength, 0.5f);
    EXPECT_EQ(scene.textures[0].wrapU, Wrap::clampToEdge);
    EXPECT_EQ(scene.textures[0].wrapV, Wrap::mirroredRepeat);
    EXPECT_TRUE(scene.textures[0].nearest);
    EXPECT_EQ(scene.images[0].rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 0, 0,
                                                               255, 255, 255, 255, 255, 128}));
}

TEST(ImportGltf, mirroredUvsSplitTheSeamAndFlipHandedness) {
    // Two unit quads side by side; the right one's u runs backwards from the shared edge.
    Mesh mesh;
    for (const float x : {0.0f, 1.0f, 2.0f})
        for (const float y : {0.0f, 1.0f}) {
            Vertex vertex;
            vertex.position = {x, y, 0};
            vertex.uv0 = {x == 1 ? 1.0f : 0.0f, 1 - y};
            mesh.vertices.push_back(vertex);
        }
    mesh.indices = {0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5};
    generateTangents(mesh);
    EXPECT_EQ(mesh.vertices.size(), 8u);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const glm::vec4 expected = i < 6 ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1);
        EXPECT_EQ(mesh.vertices[mesh.indices[i]].tangent, expected) << i;
    }
}

TEST(ImportGltf, tangentsFollowTheTextureTransform) {
    Mesh mesh;
    mesh.vertices.resize(3);
    mesh.vertices[1].position = {1, 0, 0};
    mesh.vertices[2].position = {0, 1, 0};
    mesh.vertices[0].uv1 = {0, 1};
    mesh.vertices[1].uv1 = {1, 1};
    mesh.indices = {0, 1, 2};
    generateTangents(mesh, 1, glm::mat3x2(0, -1, 1, 0, 0, 0));  // u' = v, v' = −u
    EXPECT_NEAR(mesh.vertices[0].tangent.y, -1, 1e-6f);
    EXPECT_EQ(mesh.vertices[0].tangent.w, 1);
}

}  // namespace
}  // namespace lodestar::scene
