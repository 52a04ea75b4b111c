// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/assimp_materials.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <fmt/format.h>

namespace lodestar::scene {
namespace {

constexpr float kPlainRoughness = 0.8f;  // of a material that says nothing about it

float linearFromSrgb(float s) {
    const float c = std::max(s, 0.0f);
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

/// A finite, non-negative colour; `fallback` where the file has none.
glm::vec3 sane(const aiColor3D& c, glm::vec3 fallback) {
    const glm::vec3 color(c.r, c.g, c.b);
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(color[i]) || color[i] < 0) return fallback;
    return glm::min(color, glm::vec3(1e6f));
}

glm::vec3 decoded(glm::vec3 srgb) {
    return {linearFromSrgb(srgb.x), linearFromSrgb(srgb.y), linearFromSrgb(srgb.z)};
}

std::optional<float> number(const aiMaterial& from, const char* key) {
    float value = 0;
    if (from.Get(key, 0, 0, value) != aiReturn_SUCCESS || !std::isfinite(value)) return {};
    return value;
}

Wrap wrapOf(aiTextureMapMode mode) {
    switch (mode) {
        case aiTextureMapMode_Mirror:
            return Wrap::mirroredRepeat;
        case aiTextureMapMode_Clamp:
        case aiTextureMapMode_Decal:
            return Wrap::clampToEdge;
        default:
            return Wrap::repeat;
    }
}

/// A material's first texture of a kind.
struct Slot {
    std::uint32_t image = 0;
    std::uint32_t uvSet = 0;
    Wrap wrapU = Wrap::repeat, wrapV = Wrap::repeat;
    bool usesAlpha = false;
};

class Converter {
public:
    Converter(const aiMaterial& from, AssimpImages& images, Scene& scene)
        : from(from), images(images), scene(scene) {}

    Material convert(const MaterialHabits& habits) {
        material.name = from.GetName().C_Str();
        baseColor();
        surface();
        transparency();
        details();
        int flag = 0;
        // Formats that do not say leave winding to chance, and other viewers show both sides.
        material.doubleSided = from.Get(AI_MATKEY_TWOSIDED, flag) != aiReturn_SUCCESS || flag != 0;
        if (from.Get(AI_MATKEY_SHADING_MODEL, flag) == aiReturn_SUCCESS)
            material.unlit = flag == aiShadingMode_NoShading && habits.unlitMeansUnlit;
        return material;
    }

private:
    std::optional<Slot> slot(aiTextureType type) {
        aiString path;
        unsigned uvSet = 0;
        aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap,
                                     aiTextureMapMode_Wrap};
        if (from.GetTextureCount(type) == 0 ||
            from.GetTexture(type, 0, &path, nullptr, &uvSet, nullptr, nullptr, modes) !=
                aiReturn_SUCCESS ||
            path.length == 0)
            return {};
        const std::optional<std::uint32_t> image = images.find(path.C_Str());
        if (!image) return {};
        int flags = 0;
        from.Get(AI_MATKEY_TEXFLAGS(type, 0), flags);
        return Slot{*image, std::min(uvSet, 1u), wrapOf(modes[0]), wrapOf(modes[1]),
                    (flags & aiTextureFlags_UseAlpha) != 0};
    }

    TextureUse use(const Slot& slot, ColorSpace space) {
        const auto same = [&](const Texture& t) {
            return t.image == slot.image && t.space == space && t.wrapU == slot.wrapU &&
                   t.wrapV == slot.wrapV;
        };
        auto found = std::ranges::find_if(scene.textures, same);
        if (found == scene.textures.end())
            found =
                scene.textures.insert(found, {slot.image, space, slot.wrapU, slot.wrapV, false});
        TextureUse result;
        result.texture = static_cast<std::uint32_t>(found - scene.textures.begin());
        result.uvSet = slot.uvSet;
        return result;
    }

    void baseColor() {
        aiColor3D color;
        glm::vec3 linear(1);
        if (from.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS)
            linear = sane(color, linear);
        else if (from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS)
            linear = decoded(sane(color, linear));
        color0 = slot(aiTextureType_BASE_COLOR);
        if (!color0) color0 = slot(aiTextureType_DIFFUSE);
        // Many exporters leave the colour black where an image gives it.
        if (color0 && linear == glm::vec3(0)) linear = glm::vec3(1);
        material.baseColor = glm::vec4(glm::min(linear, 1.0f), 1);
    }

    void surface() {
        material.metallic =
            std::clamp(number(from, "$mat.metallicFactor").value_or(0.0f), 0.0f, 1.0f);
        material.roughness = roughness();
        if (const auto packed = slot(aiTextureType_UNKNOWN)) {  // glTF's own
            material.metallicRoughnessTexture = use(*packed, ColorSpace::linear);
            return;
        }
        const auto metal = slot(aiTextureType_METALNESS);
        const auto rough = slot(aiTextureType_DIFFUSE_ROUGHNESS);
        if (!metal && !rough) return;
        Slot both = metal ? *metal : *rough;
        both.image = images.metallicRoughness(metal ? std::optional(metal->image) : std::nullopt,
                                              rough ? std::optional(rough->image) : std::nullopt);
        material.metallicRoughnessTexture = use(both, ColorSpace::linear);
        // The images give the values; factors beside them are leftovers in these formats.
        if (metal) material.metallic = 1;
        if (rough) material.roughness = 1;
    }

    float roughness() const {
        if (const auto value = number(from, "$mat.roughnessFactor"))
            return std::clamp(*value, 0.0f, 1.0f);
        if (const auto gloss = number(from, "$mat.glossinessFactor"))
            return 1 - std::clamp(*gloss, 0.0f, 1.0f);
        // Walter et al. 2007, section 5.2: a Phong exponent n is a Beckmann width of √(2 / (n +
        // 2)), which is roughness².
        const auto shininess = number(from, "$mat.shininess");
        if (!shininess || *shininess <= 0) return kPlainRoughness;
        return std::clamp(std::pow(2 / (*shininess + 2), 0.25f), 0.05f, 1.0f);
    }

    void transparency() {
        // 0 is what exporters write that mean the opposite: nobody models what is never seen.
        const float opacity = number(from, "$mat.opacity").value_or(1);
        if (opacity > 0 && opacity < 1) {
            material.baseColor.a = opacity;
            material.alphaMode = AlphaMode::blend;
        }
        if (color0 && color0->usesAlpha) material.alphaMode = AlphaMode::mask;
        if (const auto opacity = slot(aiTextureType_OPACITY)) {
            const std::optional<std::uint32_t> color =
                color0 ? std::optional(color0->image) : std::nullopt;
            if (!color0) color0 = opacity;
            // The same image in both places has its alpha already.
            if (color != opacity->image) color0->image = images.withAlpha(color, opacity->image);
            material.alphaMode = AlphaMode::mask;
        }
        aiString mode;
        if (from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
            const std::string_view name(mode.C_Str());
            material.alphaMode = name == "MASK"    ? AlphaMode::mask
                                 : name == "BLEND" ? AlphaMode::blend
                                                   : AlphaMode::opaque;
            material.alphaCutoff = number(from, "$mat.gltf.alphaCutoff").value_or(0.5f);
        }
        if (color0) material.baseColorTexture = use(*color0, ColorSpace::srgb);
    }

    void details() {
        if (const auto normals = slot(aiTextureType_NORMALS)) {
            material.normalTexture = use(*normals, ColorSpace::linear);
        } else if (const auto bumps = slot(aiTextureType_HEIGHT)) {
            // OBJ has one keyword for both, and most files of today mean normals.
            if (images.looksLikeNormals(bumps->image))
                material.normalTexture = use(*bumps, ColorSpace::linear);
            else
                scene.notes.push_back(
                    fmt::format("material '{}': its height map is not drawn", material.name));
        }
        if (const auto occlusion = slot(aiTextureType_AMBIENT_OCCLUSION))
            material.occlusionTexture = use(*occlusion, ColorSpace::linear);
        aiColor3D color;
        if (from.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS)
            material.emissive = decoded(sane(color, glm::vec3(0)));
        auto emissive = slot(aiTextureType_EMISSIVE);
        if (!emissive) emissive = slot(aiTextureType_EMISSION_COLOR);
        if (emissive) {
            material.emissiveTexture = use(*emissive, ColorSpace::srgb);
            if (material.emissive == glm::vec3(0)) material.emissive = glm::vec3(1);
        } else if (from.GetTextureCount(aiTextureType_EMISSIVE) +
                       from.GetTextureCount(aiTextureType_EMISSION_COLOR) >
                   0) {
            material.emissive = glm::vec3(0);  // without its image, all of the surface would glow
        }
        if (const auto strength = number(from, "$mat.emissiveIntensity"))
            material.emissive *= std::clamp(*strength, 0.0f, 1e4f);
    }

    const aiMaterial& from;
    AssimpImages& images;
    Scene& scene;
    Material material;
    std::optional<Slot> color0;
};

}  // namespace

Material convertMaterial(const aiMaterial& from, AssimpImages& images, const MaterialHabits& habits,
                         Scene& scene) {
    return Converter(from, images, scene).convert(habits);
}

}  // namespace lodestar::scene
