// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/displaced_meshes.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lodestar::scene {
namespace {

void check(const Displacement& d, const Mesh& mesh) {
    const auto sound = [](float v) { return std::isfinite(v); };
    if (!sound(d.amplitude) || d.amplitude < 0 || !sound(d.wavelength) || !(d.wavelength > 0) ||
        d.octaves < 1 || d.octaves > shared::LS_TESS_LEVELS || mesh.deforms())
        throw std::invalid_argument(
            "Mesh::displacement of '" + mesh.name +
            "': amplitude >= 0, wavelength > 0, 1 ... 3 octaves, and no joints or targets");
}

}  // namespace

DisplacedMeshes findDisplaced(const Scene& scene, std::span<const shared::GpuMesh> meshes,
                              std::span<const shared::GpuLod> lods) {
    DisplacedMeshes found{.records = {{}}, .pairs = {{}}};
    std::uint64_t triangles = 0;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const std::uint32_t number = scene.instances[i].mesh;
        const Mesh& mesh = scene.meshes[number];
        if (!mesh.displacement || mesh.indices.empty()) continue;
        check(*mesh.displacement, mesh);
        const auto record = static_cast<std::uint32_t>(found.records.size());
        found.ofInstance.resize(scene.instances.size());
        found.ofInstance[i] = record;
        const shared::GpuLod& lod = lods[meshes[number].firstLod];
        found.records.push_back({.amplitude = mesh.displacement->amplitude,
                                 .wavelength = mesh.displacement->wavelength,
                                 .octaves = mesh.displacement->octaves,
                                 .instance = i,
                                 .firstPair = static_cast<std::uint32_t>(found.pairs.size()),
                                 .firstMeshlet = lod.firstMeshlet,
                                 .meshletCount = lod.meshletCount});
        for (std::uint32_t m = 0; m < lod.meshletCount; ++m)
            found.pairs.push_back({record, lod.firstMeshlet + m});
        triangles += mesh.indices.size() / 3;
    }
    found.places = std::min<std::uint64_t>(triangles, shared::LS_TESS_CAPACITY);
    return found;
}

}  // namespace lodestar::scene
