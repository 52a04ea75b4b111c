// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <tuple>

#include <lodestar/scene/import_gltf_convert.hpp>

namespace lodestar::scene::gltf {

namespace {

Wrap wrapOf(int wrap) {
    switch (wrap) {
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return Wrap::clampToEdge;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return Wrap::mirroredRepeat;
        default:
            return Wrap::repeat;
    }
}

glm::vec2 pairOr(const Place& holder, const char* key, glm::vec2 otherwise) {
    const std::optional<Place> member = holder.find(key);
    if (!member) return otherwise;
    const std::vector<double> numbers = member->numbers(2);
    return {numbers[0], numbers[1]};
}

double numberOr(const Place& holder, const char* key, double otherwise) {
    const std::optional<Place> member = holder.find(key);
    return member ? member->number() : otherwise;
}

/// KHR_texture_transform: translation · rotation · scale. The rotation is counter-clockwise with u
/// to the right and v up, hence as written for v down: what the extension's test model expects (its
/// text long printed the matrix of the opposite sense).
glm::mat3x2 transformOf(const Place& extension) {
    const glm::vec2 offset = pairOr(extension, "offset", {0, 0});
    const glm::vec2 scale = pairOr(extension, "scale", {1, 1});
    const double angle = numberOr(extension, "rotation", 0);
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    return {glm::vec2(c, -s) * scale.x, glm::vec2(s, c) * scale.y, offset};
}

class MaterialConverter {
public:
    explicit MaterialConverter(Conversion& conversion) : c(conversion) {}

    Material convert(std::size_t index);
    /// Documents' images in the order that Texture::image refers to.
    const std::vector<std::size_t>& usedImages() const { return images; }

private:
    TextureUse use(const Place& holder, const char* key, ColorSpace space);
    std::uint32_t textureFor(std::size_t texture, ColorSpace space);
    void applySpecularGlossiness(const Place& extension, Material& material);

    Conversion& c;
    std::vector<std::size_t> images;
    std::map<std::size_t, std::uint32_t> imageSlots;
    std::map<std::tuple<std::uint32_t, ColorSpace, Wrap, Wrap, bool>, std::uint32_t> textureSlots;
};

std::uint32_t MaterialConverter::textureFor(std::size_t index, ColorSpace space) {
    const tinygltf::Texture& source = c.model.textures[index];
    if (source.source < 0) {
        c.notes.count("{} texture uses have no PNG or JPEG image: left out");
        return kNone;
    }
    const auto image = static_cast<std::size_t>(source.source);
    const auto [slot, isNew] =
        imageSlots.try_emplace(image, static_cast<std::uint32_t>(images.size()));
    if (isNew) images.push_back(image);

    Texture texture;
    texture.image = slot->second;
    texture.space = space;
    if (source.sampler >= 0) {
        const tinygltf::Sampler& sampler =
            c.model.samplers[static_cast<std::size_t>(source.sampler)];
        texture.wrapU = wrapOf(sampler.wrapS);
        texture.wrapV = wrapOf(sampler.wrapT);
        texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    const auto [known, isNewTexture] = textureSlots.try_emplace(
        {texture.image, texture.space, texture.wrapU, texture.wrapV, texture.nearest},
        static_cast<std::uint32_t>(c.scene.textures.size()));
    if (isNewTexture) c.scene.textures.push_back(texture);
    return known->second;
}

TextureUse MaterialConverter::use(const Place& holder, const char* key, ColorSpace space) {
    TextureUse use;
    const std::optional<Place> info = holder.find(key);
    if (!info) return use;
    use.texture = textureFor(info->get("index").whole(), space);
    std::uint64_t set = 0;
    if (const std::optional<Place> member = info->find("texCoord")) set = member->whole();
    if (const std::optional<Place> transform = info->extension("KHR_texture_transform")) {
        use.transform = transformOf(*transform);
        if (const std::optional<Place> member = transform->find("texCoord")) set = member->whole();
    }
    if (set > 1) {
        c.notes.count("{} texture uses ask for a UV set above 1: drawn with set 0");
        set = 0;
    }
    use.uvSet = static_cast<std::uint32_t>(set);
    return use;
}

void MaterialConverter::applySpecularGlossiness(const Place& extension, Material& material) {
    c.notes.count(
        "{} specular-glossiness materials: drawn with their diffuse colour as dielectrics");
    if (const std::optional<Place> diffuse = extension.find("diffuseFactor")) {
        const std::vector<double> color = diffuse->numbers(4);
        material.baseColor = glm::vec4(color[0], color[1], color[2], color[3]);
    } else {
        material.baseColor = glm::vec4(1);
    }
    material.baseColorTexture = use(extension, "diffuseTexture", ColorSpace::srgb);
    material.metallicRoughnessTexture = {};
    material.metallic = 0;
    material.roughness =
        1 - std::clamp(static_cast<float>(numberOr(extension, "glossinessFactor", 1)), 0.0f, 1.0f);
}

Material MaterialConverter::convert(std::size_t index) {
    const Place place = c.document.root().get("materials")[index];
    const tinygltf::Material& source = c.model.materials[index];
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    Material material;
    material.name = cleaned(source.name);
    for (int i = 0; i < 4; ++i)
        material.baseColor[i] =
            static_cast<float>(pbr.baseColorFactor[static_cast<std::size_t>(i)]);
    for (int i = 0; i < 3; ++i)
        material.emissive[i] =
            static_cast<float>(source.emissiveFactor[static_cast<std::size_t>(i)]);
    material.metallic = std::clamp(static_cast<float>(pbr.metallicFactor), 0.0f, 1.0f);
    material.roughness = std::clamp(static_cast<float>(pbr.roughnessFactor), 0.0f, 1.0f);
    material.normalScale = static_cast<float>(source.normalTexture.scale);
    material.occlusionStrength =
        std::clamp(static_cast<float>(source.occlusionTexture.strength), 0.0f, 1.0f);
    material.doubleSided = source.doubleSided;
    material.alphaCutoff = static_cast<float>(source.alphaCutoff);
    if (source.alphaMode == "MASK") material.alphaMode = AlphaMode::mask;
    if (source.alphaMode == "BLEND") {
        material.alphaMode = AlphaMode::blend;
        material.alphaCutoff = 0.5f;
    }
    if (const std::optional<Place> metallicRoughness = place.find("pbrMetallicRoughness")) {
        material.baseColorTexture = use(*metallicRoughness, "baseColorTexture", ColorSpace::srgb);
        material.metallicRoughnessTexture =
            use(*metallicRoughness, "metallicRoughnessTexture", ColorSpace::linear);
    }
    material.normalTexture = use(place, "normalTexture", ColorSpace::linear);
    material.occlusionTexture = use(place, "occlusionTexture", ColorSpace::linear);
    material.emissiveTexture = use(place, "emissiveTexture", ColorSpace::srgb);
    material.unlit = place.extension("KHR_materials_unlit").has_value();
    if (const std::optional<Place> gloss = place.extension("KHR_materials_pbrSpecularGlossiness"))
        applySpecularGlossiness(*gloss, material);
    if (const std::optional<Place> strength = place.extension("KHR_materials_emissive_strength"))
        material.emissive *= static_cast<float>(numberOr(*strength, "emissiveStrength", 1));
    constexpr float kBrightest = 1e9f;  // far above the sun's disc, far below overflow
    material.emissive = glm::clamp(material.emissive, 0.0f, kBrightest);
    return material;
}

}  // namespace

void convertMaterials(Conversion& conversion) {
    MaterialConverter converter(conversion);
    for (std::size_t i = 0; i < conversion.model.materials.size(); ++i)
        conversion.scene.materials.push_back(converter.convert(i));
    conversion.scene.images = decodeImages(conversion.document, converter.usedImages());
}

}  // namespace lodestar::scene::gltf
