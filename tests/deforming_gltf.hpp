// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gltf_builder.hpp"

/// A triangle with two joints (nodes 1 and 2, node 2 below node 1) and two morph targets; an
/// animation moves the second joint and the weights. Node 0 shows it.
inline GltfBuilder deformingGltf() {
    GltfBuilder b;
    const std::vector<std::uint8_t> joints = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    nlohmann::json& primitive =
        b.show({{"POSITION", b.floats({0, 0, 0, 1, 0, 0, 1, 1, 0}, "VEC3")},
                {"JOINTS_0", b.accessor(b.view(joints), 5121, "VEC4", 3)},
                {"WEIGHTS_0", b.floats({1, 0, 0, 0, 3, 0, 0, 0, 2, 2, 0, 0}, "VEC4")}});
    primitive["targets"] = {{{"POSITION", b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}},
                            {{"POSITION", b.floats({0, 0, 0, 0, 0, 0, 0, 2, 0}, "VEC3")}}};
    b.json["meshes"][0]["weights"] = {0, 0.5};
    b.json["nodes"][0]["skin"] = 0;
    b.add("nodes", {{"children", {2}}, {"translation", {10, 0, 0}}});
    b.add("nodes", {{"translation", {0, 5, 0}}});
    std::vector<float> bind(32, 0.0f);
    for (std::size_t i = 0; i < 4; ++i) bind[5 * i] = bind[16 + 5 * i] = 1;
    bind[12] = -1;  // the first joint was bound at x = 1
    b.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", b.floats(bind, "MAT4")}});
    const std::size_t times = b.floats({0, 1}, "SCALAR");
    b.add("animations", {{"samplers",
                          {{{"input", times}, {"output", b.floats({0, 5, 0, 0, 7, 0}, "VEC3")}},
                           {{"input", times}, {"output", b.floats({0, 0.5, 1, -1}, "SCALAR")}}}},
                         {"channels",
                          {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}},
                           {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
    return b;
}
