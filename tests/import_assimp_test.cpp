// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <stb_image_write.h>
#include <glm/gtc/matrix_transform.hpp>

#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/import.hpp>

/// assimp loses memory of its own on files it refuses; LeakSanitizer is to look for ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libassimp";
}

namespace lodestar::scene {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed after it.
class ImportAssimp : public testing::Test {
protected:
    ImportAssimp()
        : folder(fs::temp_directory_path() /
                 (std::string("lodestar_import_assimp_") +
                  testing::UnitTest::GetInstance()->current_test_info()->name())) {
        fs::remove_all(folder);
        fs::create_directories(folder / "maps");
    }
    ~ImportAssimp() override { fs::remove_all(folder); }

    fs::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        return folder / name;
    }

    /// A 2 × 2 PNG; texels from the top left.
    void writePng(const std::string& name, const std::array<glm::u8vec4, 4>& texels) const {
        stbi_write_png((folder / name).string().c_str(), 2, 2, 4, texels.data(), 8);
    }

    Scene imported(const std::string& name, const std::string& bytes) const {
        Result<Scene> scene = importAssimp(write(name, bytes));
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? std::move(*scene) : Scene{};
    }

    std::string refusal(const std::string& name, const std::string& bytes) const {
        const fs::path path = write(name, bytes);
        const Result<Scene> scene = importAssimp(path);
        EXPECT_FALSE(scene) << name;
        if (scene) return "";
        const std::string& message = scene.error().message;
        EXPECT_EQ(message.find(path.string() + ": "), 0u) << message;
        EXPECT_EQ(message.find('\n'), message.npos) << message;
        return message.substr(path.string().size() + 2);
    }

    fs::path folder;
};

std::vector<glm::mat4> nodeMatrices(const Scene& scene) {
    std::vector<glm::mat4> world;
    for (const Node& node : scene.nodes) {
        EXPECT_TRUE(node.hasMatrix);
        EXPECT_TRUE(node.parent == kNone || node.parent < world.size());
        world.push_back(node.parent == kNone ? node.matrix : world[node.parent] * node.matrix);
    }
    return world;
}

/// Everything a renderer relies on.
void expectSound(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
        EXPECT_LT(mesh.material, scene.materials.size());
        EXPECT_EQ(mesh.indices.size() % 3, 0u);
        ASSERT_FALSE(mesh.indices.empty());
        ASSERT_LT(*std::max_element(mesh.indices.begin(), mesh.indices.end()),
                  mesh.vertices.size());
        EXPECT_FALSE(mesh.bounds.empty());
        std::size_t bad = 0;
        for (const Vertex& v : mesh.vertices) {
            const glm::vec3 tangent(v.tangent);
            const bool good = std::abs(glm::length(v.normal) - 1) < 1e-3f &&
                              std::abs(glm::length(tangent) - 1) < 1e-3f &&
                              std::abs(glm::dot(v.normal, tangent)) < 1e-2f &&
                              std::abs(v.tangent.w) == 1 && std::isfinite(v.uv0.x + v.uv0.y);
            bad += !good;
        }
        EXPECT_EQ(bad, 0u) << mesh.name;
    }
    for (const Instance& instance : scene.instances) {
        EXPECT_LT(instance.mesh, scene.meshes.size());
        EXPECT_LT(instance.node, scene.nodes.size());
    }
    for (const Texture& texture : scene.textures) EXPECT_LT(texture.image, scene.images.size());
    for (const Image& image : scene.images)
        EXPECT_EQ(image.rgba.size(), std::size_t(image.width) * std::size_t(image.height) * 4);
    for (const Light& light : scene.lights) EXPECT_LT(light.node, scene.nodes.size());
    for (const SceneCamera& camera : scene.cameras) EXPECT_LT(camera.node, scene.nodes.size());
    nodeMatrices(scene);
}

const std::string kQuad =
    "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3 4/4\n";

constexpr glm::u8vec4 kRed{255, 0, 0, 255}, kGreen{0, 255, 0, 255}, kBlue{0, 0, 255, 255},
    kGrey{128, 128, 128, 255};

TEST_F(ImportAssimp, quadBecomesTwoTrianglesWithFrame) {
    const Scene scene = imported("quad.obj", kQuad);
    expectSound(scene);
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.indices.size(), 6u);
    EXPECT_EQ(mesh.vertices.size(), 4u);  // identical corners are joined
    EXPECT_EQ(mesh.bounds.upper, glm::vec3(2, 1, 0));
    for (const Vertex& v : mesh.vertices) {
        EXPECT_LT(glm::distance(v.normal, glm::vec3(0, 0, 1)), 1e-5f);
        EXPECT_LT(glm::distance(v.tangent, glm::vec4(1, 0, 0, 1)), 1e-5f);
        // OBJ counts v from the bottom, the scene from the top.
        EXPECT_EQ(v.uv0, glm::vec2(v.position.x / 2, 1 - v.position.y));
    }
}

TEST_F(ImportAssimp, mirroredTextureHasANegativeTangentSign) {
    const Scene scene = imported(
        "mirrored.obj",
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 3/3 4/4\n");
    for (const Vertex& v : scene.meshes.at(0).vertices)
        EXPECT_LT(glm::distance(v.tangent, glm::vec4(-1, 0, 0, -1)), 1e-5f);
}

TEST_F(ImportAssimp, sharpEdgesGetTheirOwnNormals) {
    // A cube without normals: 6 sides of 4 vertices, each normal along an axis.
    const Scene scene =
        imported("cube.obj",
                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                 "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n");
    ASSERT_EQ(scene.meshes.at(0).vertices.size(), 24u);
    for (const Vertex& v : scene.meshes[0].vertices) {
        const glm::vec3 outwards = v.position - 0.5f;
        EXPECT_NEAR(glm::dot(v.normal, outwards), 0.5f, 1e-5f);
    }
}

TEST_F(ImportAssimp, classicMaterialBecomesMetallicRoughness) {
    write("m.mtl", "newmtl shiny\nKd 0.5 0.25 1\nKs 1 1 1\nNs 1000\nd 0.25\n");
    const Scene scene = imported("m.obj", "mtllib m.mtl\nusemtl shiny\n" + kQuad);
    const Material& material = scene.materials.at(scene.meshes.at(0).material);
    EXPECT_EQ(material.name, "shiny");
    EXPECT_NEAR(material.baseColor.r, 0.21404f, 1e-4);  // sRGB ½ in linear light
    EXPECT_NEAR(material.baseColor.b, 1, 1e-6);
    EXPECT_EQ(material.metallic, 0);
    EXPECT_NEAR(material.roughness, std::pow(2 / 1002.0, 0.25), 1e-4);
    EXPECT_EQ(material.alphaMode, AlphaMode::blend);
    EXPECT_NEAR(material.baseColor.a, 0.25f, 1e-6);
}

TEST_F(ImportAssimp, texturesBesideTheModelAreFoundHoweverTheyAreSpelt) {
    writePng("maps/Paint.png", {kRed, kGreen, kBlue, kGrey});
    write("m.mtl",
          "newmtl a\nmap_Kd maps\\Paint.png\nnewmtl b\nmap_Kd C:\\work\\maps\\PAINT.PNG\n");
    writePng("paint.png", {kBlue, kBlue, kBlue, kBlue});
    const Scene scene =
        imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad + "usemtl b\nf 1/1 2/2 3/3\n");
    expectSound(scene);
    ASSERT_EQ(scene.images.size(), 2u);
    for (const Material& material : scene.materials) {
        if (material.name != "a" && material.name != "b") continue;
        ASSERT_NE(material.baseColorTexture.texture, kNone) << material.name;
        const Texture& texture = scene.textures.at(material.baseColorTexture.texture);
        EXPECT_EQ(texture.space, ColorSpace::srgb);
        const Image& image = scene.images.at(texture.image);
        const std::uint8_t* first = image.rgba.data();  // the top left texel
        EXPECT_EQ(first[0], material.name == "a" ? 255 : 0);
        EXPECT_EQ(first[2], material.name == "a" ? 0 : 255);
    }
}

TEST_F(ImportAssimp, opacityImageBecomesTheAlphaOfAMask) {
    writePng("color.png", {kRed, kRed, kRed, kRed});
    writePng("holes.png", {glm::u8vec4(0, 0, 0, 255), glm::u8vec4(255), kGrey, glm::u8vec4(255)});
    write("m.mtl", "newmtl a\nmap_Kd color.png\nmap_d holes.png\n");
    const Scene scene = imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad);
    const Material& material = scene.materials.at(scene.meshes.at(0).material);
    EXPECT_EQ(material.alphaMode, AlphaMode::mask);
    const Image& image =
        scene.images.at(scene.textures.at(material.baseColorTexture.texture).image);
    const int alphas[4] = {0, 255, 128, 255};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(image.rgba[4 * i], 255);
        EXPECT_EQ(image.rgba[4 * i + 3], alphas[i]);
    }
}

TEST_F(ImportAssimp, bumpImageIsUsedOnlyWhereItHoldsNormals) {
    writePng("normals.png", {glm::u8vec4(128, 128, 255, 255), glm::u8vec4(140, 120, 250, 255),
                             glm::u8vec4(120, 120, 250, 255), glm::u8vec4(128, 128, 255, 255)});
    writePng("heights.png", {kGrey, glm::u8vec4(255), kGrey, kGrey});
    write("m.mtl", "newmtl a\nmap_Bump normals.png\nnewmtl b\nmap_Bump heights.png\n");
    const Scene scene =
        imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad + "usemtl b\nf 1/1 2/2 3/3\n");
    for (const Material& material : scene.materials) {
        if (material.name == "a") {
            ASSERT_NE(material.normalTexture.texture, kNone);
            EXPECT_EQ(scene.textures[material.normalTexture.texture].space, ColorSpace::linear);
        }
        if (material.name == "b") {
            EXPECT_EQ(material.normalTexture.texture, kNone);
        }
    }
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("material 'b'"), std::string::npos);
}

TEST_F(ImportAssimp, missingOrBrokenTextureIsANoteAndNoTexture) {
    write("broken.png", "\x89PNG\r\n\x1a\n and no more");
    write("m.mtl", "newmtl a\nmap_Kd gone.png\nnewmtl b\nmap_Kd broken.png\n");
    const Scene scene =
        imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad + "usemtl b\nf 1/1 2/2 3/3\n");
    expectSound(scene);
    EXPECT_TRUE(scene.textures.empty());
    ASSERT_EQ(scene.notes.size(), 2u);
    EXPECT_NE((scene.notes[0] + scene.notes[1]).find("'gone.png' is not beside the model"),
              std::string::npos);
    EXPECT_NE((scene.notes[0] + scene.notes[1]).find("'broken.png'"), std::string::npos);
}

TEST_F(ImportAssimp, imageThatClaimsToBeHugeIsLeftOut) {
    std::string bomb("\0\0\2\0\0\0\0\0\0\0\0\0\xff\x7f\xff\x7f\x20\0", 18);  // TGA 32767²
    write("bomb.tga", bomb + std::string(64, 'x'));
    write("m.mtl", "newmtl a\nmap_Kd bomb.tga\n");
    const Scene scene = imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad);
    EXPECT_TRUE(scene.images.empty());
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("is too large: 32767 x 32767 texels"), std::string::npos);
}

TEST_F(ImportAssimp, normalsAgainstTheWindingTurnAround) {
    for (const char* normal : {"0 0 1", "0 0 -1"}) {
        const Scene scene =
            imported("n.stl", "solid s\nfacet normal " + std::string(normal) +
                                  "\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                                  "endloop\nendfacet\nendsolid s\n");
        expectSound(scene);
        for (const Vertex& v : scene.meshes.at(0).vertices)
            EXPECT_EQ(v.normal, glm::vec3(0, 0, 1)) << "of a file that says " << normal;
    }
}

TEST_F(ImportAssimp, sharpEdgesStaySharpWhereTheFileHasNoNormals) {
    std::string cube = "OFF\n8 6 0\n";
    for (int i = 0; i < 8; ++i)
        cube += std::to_string(i & 1) + ' ' + std::to_string(i >> 1 & 1) + ' ' +
                std::to_string(i >> 2) + '\n';
    cube += "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
    const Scene scene = imported("cube.off", cube);
    expectSound(scene);
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.vertices.size(), 24u);  // three a corner: equal ones are one again
    for (const Vertex& v : mesh.vertices) {
        const glm::vec3 n = glm::abs(v.normal);
        EXPECT_NEAR(std::max({n.x, n.y, n.z}), 1, 1e-6);
    }
}

TEST_F(ImportAssimp, opacityOfNothingMeansOpaque) {
    write("m.mtl", "newmtl a\nd 0\nnewmtl b\nd 0.4\n");
    const Scene scene =
        imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad + "usemtl b\nf 1/1 2/2 3/3\n");
    for (const Mesh& mesh : scene.meshes) {
        const Material& material = scene.materials[mesh.material];
        EXPECT_EQ(material.alphaMode, material.name == "a" ? AlphaMode::opaque : AlphaMode::blend);
        EXPECT_NEAR(material.baseColor.a, material.name == "a" ? 1 : 0.4f, 1e-6);
    }
    EXPECT_EQ(scene.notes.size(), 0u);
}

TEST_F(ImportAssimp, lampWithoutItsPictureIsDark) {
    write("m.mtl", "newmtl a\nKe 3 3 0\nmap_Ke gone.png\nnewmtl b\nKe 1 1 0\n");
    const Scene scene =
        imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad + "usemtl b\nf 1/1 2/2 3/3\n");
    for (const Mesh& mesh : scene.meshes) {
        const Material& material = scene.materials[mesh.material];
        EXPECT_EQ(material.emissive.r, material.name == "a" ? 0 : 1) << material.name;
    }
}

TEST_F(ImportAssimp, imageThatWouldDecodeForMinutesIsLeftOut) {
    std::string jpeg("\xff\xd8\xff\xc2\0\x0b\x08\0\x10\0\x10\1\1\x11\0", 15);
    for (int i = 0; i < 1000; ++i) jpeg += std::string("\xff\xda\0\x08\1\1\0\0\0\0", 10);
    write("scans.jpg", jpeg);
    write("m.mtl", "newmtl a\nmap_Kd scans.jpg\n");
    const Scene scene = imported("m.obj", "mtllib m.mtl\nusemtl a\n" + kQuad);
    EXPECT_TRUE(scene.images.empty());
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("has 1000 scans"), std::string::npos) << scene.notes[0];
}

TEST_F(ImportAssimp, vertexColoursAreLinearAndNotDimmed) {
    const Scene scene =
        imported("c.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                 "0 0 0 255 188 0\n1 0 0 255 188 0\n0 1 0 255 188 0\n3 0 1 2\n");
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(scene.materials.at(mesh.material).baseColor, glm::vec4(1));
    for (const Vertex& v : mesh.vertices) {
        EXPECT_NEAR(v.color.r, 1, 1e-5);
        EXPECT_NEAR(v.color.g, 0.503f, 1e-3);
        EXPECT_NEAR(v.color.b, 0, 1e-5);
        EXPECT_EQ(v.color.a, 1);
    }
}

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uint int vertex_indices\nend_header\n";

TEST_F(ImportAssimp, untrueFilesAreRefusedInOneLine) {
    EXPECT_EQ(refusal("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"),
              "mesh 'defaultobject': the position of vertex 1 is not finite");
    EXPECT_NE(refusal("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n").find("beyond 1e+18"),
              std::string::npos);
    EXPECT_NE(refusal("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").find("index"),
              std::string::npos);
    EXPECT_NE(refusal("index.ply", kPlyHead + "0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n").find("range"),
              std::string::npos);
    EXPECT_NE(refusal("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n").find("face 0"),
              std::string::npos);
    EXPECT_NE(refusal("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n").find("no triangles"),
              std::string::npos);
    refusal("empty.obj", "");
    refusal("empty.stl", "");
    refusal("text.fbx", "Kaydara FBX Binary  \0");
}

TEST_F(ImportAssimp, countsBeyondTheFileAreRefusedBeforeAllocating) {
    EXPECT_NE(refusal("v.ply",
                      "ply\nformat ascii 1.0\nelement vertex 4000000000\n"
                      "property float x\nend_header\n0\n")
                  .find("4000000000 rows"),
              std::string::npos);
    EXPECT_NE(refusal("f.ply", kPlyHead + "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n")
                  .find("row 0 of element 'face'"),
              std::string::npos);
    EXPECT_NE(refusal("e.ply", "ply\nformat ascii 1.0\nelement nothing 9\nend_header\n0 0 0 0 0\n")
                  .find("element 'nothing'"),
              std::string::npos);
    std::string binary = kPlyHead;
    binary.replace(binary.find("ascii"), 5, "binary_big_endian");
    EXPECT_NE(refusal("b.ply", binary + std::string(36, '\0') + "\xf0\0\0\0" + "123456789012")
                  .find("row 0 of element 'face'"),
              std::string::npos);
    refusal("v.off", "OFF\n353535235358 6 0\n0 0 0\n");
    refusal("f.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n");
}

TEST_F(ImportAssimp, everyTruncationAndBitFlipLoadsOrIsRefused) {
    std::string stl(80, ' ');
    stl += std::string("\1\0\0\0", 4);
    for (const float f : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) {
        char bytes[4];
        std::memcpy(bytes, &f, 4);
        stl.append(bytes, 4);
    }
    stl.append(2, '\0');
    std::string binary = kPlyHead;
    binary.replace(binary.find("ascii"), 5, "binary_little_endian");
    binary += stl.substr(96, 36) + std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0", 16);
    const std::pair<const char*, std::string> files[] = {
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nf 1/1 2/1 3/1\n"},
        {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        {"a.ply", kPlyHead + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        {"b.ply", binary},
        {"a.stl", stl}};
    int loaded = 0, refused = 0;
    const auto check = [&](const char* name, const std::string& bytes) {
        const Result<Scene> scene = importAssimp(write(name, bytes));
        (scene ? loaded : refused) += 1;
        if (scene) expectSound(*scene);
    };
    for (const auto& [name, bytes] : files) {
        ASSERT_TRUE(importAssimp(write(name, bytes))) << name;
        for (std::size_t length = 0; length < bytes.size(); length += 3)
            check(name, bytes.substr(0, length));
        for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += 7) {
            std::string flipped = bytes;
            flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
            check(name, flipped);
        }
    }
    EXPECT_GT(loaded, 100);
    EXPECT_GT(refused, 100);
}

/// The folder of Debian's assimp-testmodels, and a model of it; skips the test without it.
class AssimpModels : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(kFolder)) GTEST_SKIP() << "assimp-testmodels is not installed";
    }

    static Scene imported(const std::string& name) {
        Result<Scene> scene = importAssimp(kFolder / name);
        EXPECT_TRUE(scene) << scene.error().message;
        if (!scene) return {};
        expectSound(*scene);
        return std::move(*scene);
    }

    inline static const fs::path kFolder = "/usr/share/assimp/models";
};

TEST_F(AssimpModels, oneModelInManyFormatsIsOneShape) {
    // The file formats put it in different units and axes; its proportions stay.
    for (const char* name :
         {"OBJ/WusonOBJ.obj", "PLY/Wuson.ply", "STL/Wuson.stl", "OFF/Wuson.off"}) {
        const Scene scene = imported(name);
        EXPECT_EQ(countTriangles(scene).drawn, 3732u) << name;
        const Bounds bounds = worldBounds(scene, nodeMatrices(scene));
        EXPECT_NEAR(bounds.upper.y, 1.51525f, 1e-4) << name;
    }
}

TEST_F(AssimpModels, texturedObjHasItsImages) {
    const Scene scene = imported("OBJ/spider.obj");
    EXPECT_EQ(countTriangles(scene).drawn, 1368u);
    EXPECT_EQ(scene.images.size(), 5u);
    EXPECT_TRUE(scene.notes.empty());
}

TEST_F(AssimpModels, colladaHasHierarchyCameraAndInstances) {
    const Scene duck = imported("Collada/duck.dae");
    EXPECT_EQ(duck.images.size(), 1u);
    ASSERT_EQ(duck.cameras.size(), 1u);
    ASSERT_FALSE(duck.lights.empty());
    const std::vector<glm::mat4> world = nodeMatrices(duck);
    const Bounds bounds = worldBounds(duck, world);
    EXPECT_NEAR(bounds.upper.y - bounds.lower.y, 1.54f, 0.01f);  // centimetres in the file
    const Camera camera = fromSceneCamera(duck.cameras[0], world[duck.cameras[0].node], 1);
    const glm::vec4 seen =
        camera.clipFromView(1.5f) * camera.viewFromWorld() * glm::vec4(bounds.centre(), 1);
    EXPECT_GT(seen.w, 0);  // it looks at the duck
    EXPECT_LT(std::abs(seen.x), 0.5f * seen.w);
    EXPECT_LT(std::abs(seen.y), 0.5f * seen.w);

    const Scene teapots = imported("Collada/teapot_instancenodes.DAE");
    EXPECT_EQ(countTriangles(teapots).drawn, 2 * countTriangles(teapots).stored);
}

TEST_F(AssimpModels, onlyUvSetServesAMaterialThatNamesTheSecond) {
    const Scene cube = imported("Collada/kwxport_test_vcolors.dae");
    ASSERT_EQ(cube.meshes.size(), 3u);
    for (const Mesh& mesh : cube.meshes) {
        EXPECT_EQ(cube.materials[mesh.material].baseColorTexture.uvSet, 1u);
        glm::vec2 lower(9), upper(-9);
        for (const Vertex& v : mesh.vertices) {
            lower = glm::min(lower, v.uv1);
            upper = glm::max(upper, v.uv1);
        }
        EXPECT_EQ(upper - lower, glm::vec2(1)) << "the whole picture on each side";
    }
}

TEST_F(AssimpModels, fbxIsInMetresAndHasItsEmbeddedImage) {
    const Scene cube = imported("FBX/box_orphant_embedded_texture.fbx");
    EXPECT_EQ(cube.images.size(), 1u);
    const Bounds bounds = worldBounds(cube, nodeMatrices(cube));
    EXPECT_NEAR(bounds.upper.y - bounds.lower.y, 1, 1e-4);
}

TEST_F(AssimpModels, everyKindOfLightAndCameraIsTaken) {
    const Scene lights = imported("Collada/lights.dae");
    EXPECT_GE(lights.lights.size(), 3u);
    const Scene cameras = imported("Collada/cameras.dae");
    EXPECT_EQ(cameras.cameras.size(), 3u);
    // The first has a horizontal angle of 49.13° at 16:9.
    EXPECT_NEAR(std::tan(0.5f * cameras.cameras[0].verticalFov),
                std::tan(0.5f * 0.857556f) * 9 / 16, 1e-4);
    for (const SceneCamera& camera : cameras.cameras) {
        EXPECT_GT(camera.verticalFov, 0.02f);
        EXPECT_LT(camera.verticalFov, 3);
    }
}

TEST_F(AssimpModels, damagedArchiveIsRefusedAndDoesNotEndTheProgram) {
    std::ifstream stream(kFolder / "3MF/box.3mf", std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    ASSERT_GT(bytes.size(), 200u);
    bytes[1103 / 8] = static_cast<char>(bytes[1103 / 8] ^ 1 << 1103 % 8);
    const fs::path path = fs::temp_directory_path() / "lodestar_import_assimp_test.3mf";
    std::ofstream(path, std::ios::binary) << bytes;
    const Result<Scene> scene = importAssimp(path);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().message.find(path.string() + ": "), 0u);
    fs::remove(path);
}

TEST_F(AssimpModels, filesMadeToBreakImportersAreRefused) {
    for (const char* name : {"invalid/OutOfMemory.off", "invalid/empty.3ds", "invalid/empty.ply",
                             "invalid/empty.x", "invalid/malformed.obj", "PLY/points.ply"}) {
        const Result<Scene> scene = importAssimp(kFolder / name);
        EXPECT_FALSE(scene) << name;
    }
}

}  // namespace
}  // namespace lodestar::scene
