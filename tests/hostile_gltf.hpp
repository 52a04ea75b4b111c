// SPDX-License-Identifier: Apache-2.0
// Shared by the parts of hostile_gltf_test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <lodestar/scene/import_gltf.hpp>

#include "gltf_builder.hpp"

namespace lodestar::scene {

using Bytes = std::vector<std::uint8_t>;

/// The error of an import, "" if it loads. An error has to be one line that names the file.
inline std::string outcome(const Result<Scene>& scene, const std::string& name) {
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

inline std::string outcome(const Bytes& file) {
    const Bytes exact(file);  // capacity = size, for ASan
    return outcome(importGltfFromMemory(exact, "hostile.glb"), "hostile.glb");
}
inline std::string outcome(const GltfBuilder& builder) {
    return outcome(builder.glb());
}
inline std::string outcome(const std::string& json) {
    return outcome(Bytes(json.begin(), json.end()));
}

inline void expectRefusedAt(const GltfBuilder& builder, const std::string& place) {
    const std::string message = outcome(builder);
    EXPECT_TRUE(message.starts_with("hostile.glb: " + place + ": ")) << "got: " << message;
}

}  // namespace lodestar::scene
