// SPDX-License-Identifier: Apache-2.0
// The vetting of a document: meshes, materials, textures and images.
#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include <lodestar/scene/import_gltf_document.hpp>

namespace lodestar::scene::gltf {

namespace {

/// What an attribute may be. Bit t of `types` allows component type kByte + t.
struct Format {
    std::string_view shape;
    unsigned types;
    std::string_view otherShape = shape;
};

constexpr unsigned bit(ComponentType type) {
    return 1u << (type - kByte);
}
// KHR_mesh_quantization widens the core types; a file that forgets to say so is still clear.
constexpr unsigned kSigned = bit(kByte) | bit(kShort) | bit(kFloat);
constexpr unsigned kSmall = bit(kByte) | bit(kUnsignedByte) | bit(kShort) | bit(kUnsignedShort);

void checkFormat(const Document& document, const Place& place, std::string_view name,
                 bool morphTarget) {
    Format format{"", 0};
    if (name == "POSITION") {
        format = {"VEC3", kSmall | bit(kFloat)};
    } else if (name == "NORMAL") {
        format = {"VEC3", kSigned};
    } else if (name == "TANGENT") {
        format = morphTarget ? Format{"VEC3", kSigned} : Format{"VEC4", kSigned};
    } else if (name.starts_with("TEXCOORD_")) {
        format = {"VEC2", kSmall | bit(kFloat)};
    } else if (name.starts_with("COLOR_")) {
        format = {"VEC3", bit(kUnsignedByte) | bit(kUnsignedShort) | bit(kFloat), "VEC4"};
        if (morphTarget) format.types |= bit(kByte) | bit(kShort);
    } else if (name.starts_with("JOINTS_")) {
        format = {"VEC4", bit(kUnsignedByte) | bit(kUnsignedShort)};
    } else if (name.starts_with("WEIGHTS_")) {
        format = {"VEC4", bit(kUnsignedByte) | bit(kUnsignedShort) | bit(kFloat)};
    } else {
        return;  // not read
    }
    const Accessor& accessor = document.accessors[place.whole()];
    const bool shapeFits = accessor.type == format.shape || accessor.type == format.otherShape;
    if (!shapeFits || (format.types & 1u << (accessor.componentType - kByte)) == 0)
        place.refuse(fmt::format("{} of component type {} is no {}", accessor.type,
                                 accessor.componentType, cleaned(name)));
}

/// Checks an attribute map; `count` is that of the first attribute, or of the base mesh.
void checkAttributes(const Document& document, const Place& attributes, bool morphTarget,
                     std::optional<std::size_t>& count) {
    for (const auto& [name, value] : attributes.object().json().items()) {
        const Place place = attributes.get(name);
        const std::size_t index = place.index(document.accessors.size(), "accessors");
        checkFormat(document, place, name, morphTarget);
        const std::size_t own = document.accessors[index].count;
        if (!count) count = own;
        if (own != *count)
            place.refuse(fmt::format("{} elements where the others have {}", own, *count));
    }
}

void checkDraco(const Document& document, const Place& draco) {
    draco.get("bufferView").index(document.views.size(), "bufferViews");
    const Place attributes = draco.get("attributes").object();
    for (const auto& [name, id] : attributes.json().items()) attributes.get(name).whole(0xffffffff);
}

void checkPrimitive(const Document& document, const Place& primitive, std::size_t materials,
                    std::optional<std::size_t>& targetCount) {
    std::optional<std::size_t> count;
    checkAttributes(document, primitive.object().get("attributes"), false, count);
    if (const std::optional<Place> material = primitive.find("material"))
        material->index(materials, "materials");
    if (const std::optional<Place> mode = primitive.find("mode"))
        if (mode->whole() > 6) mode->refuse(fmt::format("{} is not a mode", mode->whole()));
    if (const std::optional<Place> indices = primitive.find("indices")) {
        const Accessor& accessor =
            document.accessors[indices->index(document.accessors.size(), "accessors")];
        const bool fits = accessor.componentType == kUnsignedByte ||
                          accessor.componentType == kUnsignedShort ||
                          accessor.componentType == kUnsignedInt;
        if (accessor.type != "SCALAR" || !fits)
            indices->refuse(fmt::format("{} of component type {} can't be indices", accessor.type,
                                        accessor.componentType));
    }
    const std::vector<Place> targets = primitive.elements("targets");
    for (const Place& target : targets) checkAttributes(document, target, true, count);
    if (!targetCount) targetCount = targets.size();
    if (targets.size() != *targetCount)
        primitive.refuse(fmt::format("{} morph targets where the mesh's others have {}",
                                     targets.size(), *targetCount));
    if (const std::optional<Place> draco = primitive.extension("KHR_draco_mesh_compression"))
        checkDraco(document, *draco);
    if (const std::optional<Place> variants = primitive.extension("KHR_materials_variants")) {
        std::size_t known = 0;
        if (const std::optional<Place> all = document.root().extension("KHR_materials_variants"))
            known = all->get("variants").array().size();
        for (const Place& mapping : variants->elements("mappings")) {
            mapping.object().get("material").index(materials, "materials");
            for (const Place& variant : mapping.elements("variants"))
                variant.index(known, "variants");
        }
    }
}

void checkTextureInfo(const Place& info, std::size_t textures) {
    info.object().get("index").index(textures, "textures");
    if (const std::optional<Place> set = info.find("texCoord")) set->whole(0xffff);
    const std::optional<Place> transform = info.extension("KHR_texture_transform");
    if (!transform) return;
    if (const std::optional<Place> offset = transform->find("offset")) offset->numbers(2);
    if (const std::optional<Place> scale = transform->find("scale")) scale->numbers(2);
    if (const std::optional<Place> rotation = transform->find("rotation")) rotation->number();
    if (const std::optional<Place> set = transform->find("texCoord")) set->whole(0xffff);
}

/// Every member named …Texture is a reference, in a material and in all of its extensions.
void checkTextureInfos(const Place& holder, std::size_t textures) {
    if (!holder.isObject()) return;
    for (const auto& [name, value] : holder.json().items())
        if (name.ends_with("Texture")) checkTextureInfo(holder.get(name), textures);
}

void checkNumbers(const Place& holder, const char* key, std::size_t count) {
    if (const std::optional<Place> member = holder.find(key)) member->numbers(count);
}

void checkNumber(const Place& holder, const char* key) {
    if (const std::optional<Place> member = holder.find(key)) member->number();
}

void checkMaterial(const Place& material, std::size_t textures) {
    checkTextureInfos(material.object(), textures);
    checkNumbers(material, "emissiveFactor", 3);
    checkNumber(material, "alphaCutoff");
    if (const std::optional<Place> mode = material.find("alphaMode")) mode->text();
    if (const std::optional<Place> doubleSided = material.find("doubleSided"))
        doubleSided->boolean();
    if (const std::optional<Place> pbr = material.find("pbrMetallicRoughness")) {
        checkTextureInfos(pbr->object(), textures);
        checkNumbers(*pbr, "baseColorFactor", 4);
        checkNumber(*pbr, "metallicFactor");
        checkNumber(*pbr, "roughnessFactor");
    }
    if (const std::optional<Place> normal = material.find("normalTexture"))
        checkNumber(*normal, "scale");
    if (const std::optional<Place> occlusion = material.find("occlusionTexture"))
        checkNumber(*occlusion, "strength");
    if (const std::optional<Place> strength = material.extension("KHR_materials_emissive_strength"))
        checkNumber(*strength, "emissiveStrength");
    if (const std::optional<Place> gloss =
            material.extension("KHR_materials_pbrSpecularGlossiness")) {
        checkNumbers(*gloss, "diffuseFactor", 4);
        checkNumber(*gloss, "glossinessFactor");
    }
    if (const std::optional<Place> all = material.find("extensions"); all && all->isObject())
        for (const auto& [name, value] : all->json().items())
            checkTextureInfos(all->get(name), textures);
}

void checkImage(const Document& document, const Place& image) {
    const std::optional<Place> uri = image.object().find("uri"), view = image.find("bufferView");
    if (uri.has_value() == view.has_value())
        image.refuse(uri ? "has both a uri and a bufferView"
                         : "has neither a uri nor a bufferView");
    if (uri) checkUri(*uri);
    if (view) view->index(document.views.size(), "bufferViews");
}

}  // namespace

void validateMeshes(Document& document) {
    const Place root = document.root();
    const std::size_t materials = root.elements("materials").size();
    for (const Place& mesh : root.elements("meshes")) {
        mesh.object().get("primitives").array();
        std::optional<std::size_t> targets;
        for (const Place& primitive : mesh.elements("primitives"))
            checkPrimitive(document, primitive, materials, targets);
        if (const std::optional<Place> weights = mesh.find("weights"))
            weights->numbers(targets.value_or(0));
    }
}

void validateMaterials(const Document& document) {
    const Place root = document.root();
    const std::size_t textures = root.elements("textures").size();
    const std::size_t images = root.elements("images").size();
    const std::size_t samplers = root.elements("samplers").size();
    for (const Place& sampler : root.elements("samplers"))
        for (const char* key : {"magFilter", "minFilter", "wrapS", "wrapT"})
            if (const std::optional<Place> member = sampler.object().find(key))
                member->whole(0xffff);
    for (const Place& image : root.elements("images")) checkImage(document, image);
    for (const Place& texture : root.elements("textures")) {
        if (const std::optional<Place> sampler = texture.object().find("sampler"))
            sampler->index(samplers, "samplers");
        if (const std::optional<Place> source = texture.find("source"))
            source->index(images, "images");
        const std::optional<Place> all = texture.find("extensions");
        if (!all || !all->isObject()) continue;
        for (const auto& [name, value] : all->json().items())  // EXT_texture_webp and its kind
            if (value.is_object())
                if (const std::optional<Place> source = all->get(name).find("source"))
                    source->index(images, "images");
    }
    for (const Place& material : root.elements("materials")) checkMaterial(material, textures);
}

}  // namespace lodestar::scene::gltf
