// SPDX-License-Identifier: Apache-2.0
// Shared by the parts of import_gltf_test.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <lodestar/scene/import.hpp>
#include <lodestar/scene/import_gltf.hpp>

#include "gltf_builder.hpp"
#include "scenes.hpp"

namespace lodestar::scene {

inline Scene imported(const std::filesystem::path& path) {
    Result<Scene> scene = importGltf(path);
    if (!scene) {
        ADD_FAILURE() << scene.error().message;
        return {};
    }
    return *std::move(scene);
}

inline Scene sample(const std::string& name) {
    return imported(scenesFolder() / "tests" / name);
}

inline Scene built(const GltfBuilder& builder) {
    Result<Scene> scene = importGltfFromMemory(builder.glb(), "built.glb");
    if (!scene) {
        ADD_FAILURE() << scene.error().message;
        return {};
    }
    return *std::move(scene);
}

inline std::string refusal(const GltfBuilder& builder) {
    const Result<Scene> scene = importGltfFromMemory(builder.glb(), "built.glb");
    return scene ? "loaded" : scene.error().message;
}

inline bool notes(const Scene& scene, const std::string& words) {
    return std::any_of(scene.notes.begin(), scene.notes.end(), [&](const std::string& note) {
        return note.find(words) != std::string::npos;
    });
}

inline const Material& materialNamed(const Scene& scene, const std::string& name) {
    for (const Material& material : scene.materials)
        if (material.name == name) return material;
    ADD_FAILURE() << "no material " << name;
    static const Material kNothing;
    return kNothing;
}

/// What every consumer of a Scene takes for granted.
inline void expectSound(const Scene& scene) {
    for (std::size_t i = 0; i < scene.nodes.size(); ++i)
        EXPECT_TRUE(scene.nodes[i].parent == kNone || scene.nodes[i].parent < i);
    for (const Instance& instance : scene.instances) {
        ASSERT_LT(instance.mesh, scene.meshes.size());
        ASSERT_LT(instance.node, scene.nodes.size());
    }
    for (const Texture& texture : scene.textures) ASSERT_LT(texture.image, scene.images.size());
    for (const Image& image : scene.images)
        EXPECT_EQ(image.rgba.size(), 4u * static_cast<std::size_t>(image.width) *
                                         static_cast<std::size_t>(image.height));
    for (const Mesh& mesh : scene.meshes) {
        ASSERT_LT(mesh.material, scene.materials.size());
        EXPECT_EQ(mesh.indices.size() % 3, 0u);
        std::size_t wrong = 0;
        for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, mesh.vertices.size());
        for (const Vertex& vertex : mesh.vertices) {
            wrong += std::abs(glm::length(vertex.normal) - 1) > 1e-4f;
            wrong += std::abs(glm::length(glm::vec3(vertex.tangent)) - 1) > 1e-4f;
            wrong += std::abs(vertex.tangent.w) != 1;
        }
        EXPECT_EQ(wrong, 0u) << mesh.name;
    }
}

}  // namespace lodestar::scene
