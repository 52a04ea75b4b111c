// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/displaced_meshes.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lodestar::scene {
namespace {

/// The mean length of its edges.
float edgeLength(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
        sum += glm::distance(mesh.vertices[mesh.indices[i]].position,
                             mesh.vertices[mesh.indices[next]].position);
    }
    return mesh.indices.empty() ? 0 : float(sum / double(mesh.indices.size()));
}

void check(const Displacement& d, const Mesh& mesh) {
    const auto sound = [](float v) { return std::isfinite(v); };
    if (!sound(d.amplitude) || d.amplitude < 0 || !sound(d.wavelength) || !(d.wavelength > 0) ||
        d.octaves < 1 || d.octaves > shared::LS_TESS_LEVELS)
        throw std::invalid_argument("Mesh::displacement of '" + mesh.name +
                                    "': amplitude >= 0, wavelength > 0 and 1 ... 3 octaves");
}

}  // namespace

DisplacedMeshes findDisplaced(const Scene& scene, std::span<const shared::GpuMesh> meshes,
                              std::span<const shared::GpuLod> lods) {
    DisplacedMeshes found{.records = {{}}, .pairs = {{}}};
    std::vector<float> edges(scene.meshes.size());
    for (std::size_t i = 0; i < edges.size(); ++i)
        if (scene.meshes[i].displacement) {
            check(*scene.meshes[i].displacement, scene.meshes[i]);
            edges[i] = edgeLength(scene.meshes[i]);
        }
    std::uint64_t triangles = 0;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const std::uint32_t number = scene.instances[i].mesh;
        const Mesh& mesh = scene.meshes[number];
        if (!mesh.displacement || !(edges[number] > 0)) continue;
        const auto record = static_cast<std::uint32_t>(found.records.size());
        found.ofInstance.resize(scene.instances.size());
        found.ofInstance[i] = record;
        const shared::GpuLod& lod = lods[meshes[number].firstLod];
        found.records.push_back({.amplitude = mesh.displacement->amplitude,
                                 .wavelength = mesh.displacement->wavelength,
                                 .octaves = mesh.displacement->octaves,
                                 .edge = edges[number],
                                 .firstPair = static_cast<std::uint32_t>(found.pairs.size()),
                                 .firstMeshlet = lod.firstMeshlet,
                                 .meshletCount = lod.meshletCount,
                                 .instance = i});
        for (std::uint32_t m = 0; m < lod.meshletCount; ++m)
            found.pairs.push_back({record, lod.firstMeshlet + m});
        triangles += mesh.indices.size() / 3;
    }
    found.places = std::min<std::uint64_t>(triangles, shared::LS_TESS_CAPACITY);
    return found;
}

}  // namespace lodestar::scene
