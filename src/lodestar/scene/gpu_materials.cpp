// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/gpu_materials.hpp>

#include <algorithm>

namespace lodestar::scene {

using shared::GpuMaterialRecord;
using shared::GpuTextureTransform;

namespace {

std::uint32_t packUse(const TextureUse& use, const Scene& scene, const TextureArrays& arrays) {
    if (use.texture == kNone) return shared::LS_NO_TEXTURE;
    const auto wrap = [](Wrap w) {
        return w == Wrap::repeat           ? shared::LS_WRAP_REPEAT
               : w == Wrap::mirroredRepeat ? shared::LS_WRAP_MIRROR
                                           : shared::LS_WRAP_CLAMP;
    };
    const Texture& texture = scene.textures[use.texture];
    const TextureSlot slot = arrays.slotOf[use.texture];
    const bool transformed = use.transform != glm::mat3x2(1, 0, 0, 1, 0, 0);
    const std::uint32_t reading = wrap(texture.wrapU) | wrap(texture.wrapV) << 2 |
                                  (texture.nearest ? shared::LS_READ_NEAREST : 0) |
                                  (use.uvSet == 1 ? shared::LS_READ_UV1 : 0) |
                                  (transformed ? shared::LS_READ_TRANSFORMED : 0);
    return slot.array | slot.layer << shared::LS_LAYER_SHIFT | reading << shared::LS_READING_SHIFT;
}

GpuTextureTransform packTransform(const TextureUse& use) {
    const glm::mat3x2& m = use.transform;
    return {.uRow = {m[0][0], m[1][0], m[2][0], 0}, .vRow = {m[0][1], m[1][1], m[2][1], 0}};
}

// What a blended surface shows from this alpha on is opaque, and drawn as a masked one. The rest is
// left to the layer (visibility::Peel).
constexpr float kOpaque = 0.98f;

/// Of each material whether it is BLEND and something of it is not opaque.
std::vector<bool> seenThrough(const Scene& scene) {
    std::vector<bool> thin(scene.materials.size());
    for (std::size_t i = 0; i < thin.size(); ++i) {
        const Material& m = scene.materials[i];
        if (m.alphaMode != AlphaMode::blend) continue;
        thin[i] = m.baseColor.a < kOpaque;
        if (thin[i] || m.baseColorTexture.texture == kNone) continue;
        const Image& image = scene.images[scene.textures[m.baseColorTexture.texture].image];
        for (std::size_t a = 3; a < image.rgba.size() && !thin[i]; a += 4)
            thin[i] = static_cast<float>(image.rgba[a]) * m.baseColor.a < 255 * kOpaque;
    }
    for (const Mesh& mesh : scene.meshes) {
        const bool blends = scene.materials[mesh.material].alphaMode == AlphaMode::blend;
        if (blends && !thin[mesh.material])
            thin[mesh.material] = std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                                              [](auto& v) { return v.color.a < kOpaque; });
    }
    return thin;
}

GpuMaterialRecord pack(const Material& m, const Scene& scene, const TextureArrays& arrays,
                       bool thin) {
    const bool masked = m.alphaMode != AlphaMode::opaque;
    return {
        .material = {.baseColor = m.baseColor,
                     .emissive = m.emissive,
                     .flags = (masked ? shared::LS_MATERIAL_MASK : 0) |
                              (m.doubleSided ? shared::LS_MATERIAL_DOUBLE_SIDED : 0) |
                              (m.unlit ? shared::LS_MATERIAL_UNLIT : 0) |
                              (thin ? shared::LS_MATERIAL_BLEND : 0),
                     .metallic = m.metallic,
                     .roughness = m.roughness,
                     .normalScale = m.normalScale,
                     .occlusionStrength = m.occlusionStrength,
                     .baseColorTexture = packUse(m.baseColorTexture, scene, arrays),
                     .normalTexture = packUse(m.normalTexture, scene, arrays),
                     .metallicRoughnessTexture = packUse(m.metallicRoughnessTexture, scene, arrays),
                     .occlusionTexture = packUse(m.occlusionTexture, scene, arrays),
                     .emissiveTexture = packUse(m.emissiveTexture, scene, arrays),
                     .alphaCutoff = m.alphaMode == AlphaMode::blend ? kOpaque : m.alphaCutoff},
        .transforms = {packTransform(m.baseColorTexture), packTransform(m.normalTexture),
                       packTransform(m.metallicRoughnessTexture), packTransform(m.occlusionTexture),
                       packTransform(m.emissiveTexture)}};
}

}  // namespace

std::vector<GpuMaterialRecord> packMaterials(const Scene& scene, const TextureArrays& arrays) {
    const std::vector<bool> thin = seenThrough(scene);
    std::vector<GpuMaterialRecord> packed;
    for (std::size_t i = 0; i < thin.size(); ++i)
        packed.push_back(pack(scene.materials[i], scene, arrays, thin[i]));
    return packed;
}

SceneFeatures featuresOf(const std::vector<GpuMaterialRecord>& materials) {
    SceneFeatures f;
    bool occlusionApart = false;
    const auto place = [](std::uint32_t use) { return use & 0xffff; };  // array and layer
    for (const auto& [m, transforms] : materials) {
        const auto note = [&](std::uint32_t use, std::uint32_t& arrays) {
            if (use == shared::LS_NO_TEXTURE) return;
            arrays |= 1u << (use & shared::LS_ARRAY_MASK);
            const std::uint32_t reading = use >> shared::LS_READING_SHIFT;
            f.uvTransforms |= reading != 0;
            f.secondUvs |= (reading & shared::LS_READ_UV1) != 0;
        };
        note(m.baseColorTexture, f.baseColorArrays);
        note(m.normalTexture, f.normalArrays);
        note(m.metallicRoughnessTexture, f.metallicRoughnessArrays);
        note(m.occlusionTexture, f.occlusionArrays);
        note(m.emissiveTexture, f.emissiveArrays);
        occlusionApart |= m.occlusionTexture != shared::LS_NO_TEXTURE &&
                          place(m.occlusionTexture) != place(m.metallicRoughnessTexture);
        f.emissive |= m.emissive != glm::vec3(0);
        f.unlit |= (m.flags & shared::LS_MATERIAL_UNLIT) != 0;
        f.blended |= (m.flags & shared::LS_MATERIAL_BLEND) != 0;
    }
    f.occlusionShared = f.occlusionArrays != 0 && !occlusionApart;
    return f;
}

}  // namespace lodestar::scene
