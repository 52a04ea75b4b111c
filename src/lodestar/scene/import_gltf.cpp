// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 in three steps: read the container, vet the document, convert it.
//
// tinygltf 2.7 makes the typed model, but it only ever sees a document that has been vetted, and
// none of its bytes: it follows some offsets unchecked, drops what it can't read without a word,
// refuses indices that are only in Draco data and buffers that exist only compressed (meshopt), and
// reads whole files wherever a URI points. Containers, buffers, accessors and images are ours.
#include <lodestar/scene/import_gltf.hpp>

#include <algorithm>
#include <limits>
#include <new>
#include <string_view>

#include <fmt/format.h>

#include <lodestar/scene/import.hpp>
#include <lodestar/scene/import_gltf_convert.hpp>

namespace lodestar::scene {

namespace gltf {

namespace {

/// Charges what tinygltf's structs take: kilobytes for a material that is two bytes of JSON.
void spendModel(Document& document) {
    const Place root = document.root();
    const auto spend = [&](const char* things, std::size_t size) {
        const std::optional<Place> all = root.find(things);
        if (all) document.spend(all->size() * 2 * size, all->path());
    };
    spend("nodes", sizeof(tinygltf::Node));
    spend("meshes", sizeof(tinygltf::Mesh));
    spend("materials", sizeof(tinygltf::Material));
    spend("textures", sizeof(tinygltf::Texture));
    spend("samplers", sizeof(tinygltf::Sampler));
    spend("cameras", sizeof(tinygltf::Camera));
    spend("skins", sizeof(tinygltf::Skin));
    spend("scenes", sizeof(tinygltf::Scene));
    spend("animations", sizeof(tinygltf::Animation));
    spend("accessors", sizeof(tinygltf::Accessor));
    for (const Place& mesh : root.elements("meshes"))
        document.spend(mesh.get("primitives").size() * 2 * sizeof(tinygltf::Primitive),
                       mesh.path());
    for (const Place& animation : root.elements("animations"))
        document.spend(
            animation.get("samplers").size() * 2 * sizeof(tinygltf::AnimationSampler) +
                animation.get("channels").size() * 2 * sizeof(tinygltf::AnimationChannel),
            animation.path());
    if (const std::optional<Place> lights = root.extension("KHR_lights_punctual"))
        document.spend(lights->elements("lights").size() * 2 * sizeof(tinygltf::Light),
                       lights->path());
}

/// tinygltf's model of everything but the bytes: for these it gets stand-ins.
tinygltf::Model modelOf(Document& document) {
    spendModel(document);
    Json stripped = Json::object();
    for (const auto& [key, value] : document.json.items())
        if (key != "buffers" && key != "bufferViews" && key != "accessors" && key != "images")
            stripped[key] = value;
    const Json accessor = {
        {"bufferView", 0}, {"componentType", kFloat}, {"count", 1}, {"type", "SCALAR"}};
    stripped["bufferViews"] = Json::array({{{"buffer", 0}, {"byteLength", 1}}});
    stripped["accessors"] = Json::array();
    for (std::size_t i = 0; i < document.accessors.size(); ++i)
        stripped["accessors"].push_back(accessor);

    const std::string text = stripped.dump();
    if (text.size() > std::numeric_limits<unsigned>::max())
        refuse("the JSON", "is over 4 GiB", "split the scene");
    tinygltf::Model model;
    std::string error, warning;
    if (!tinygltf::TinyGLTF().LoadASCIIFromString(&model, &error, &warning, text.data(),
                                                  static_cast<unsigned>(text.size()), ""))
        refuse("the JSON", "tinygltf: " + cleaned(error));
    // The two views of the document go by the same indices.
    const Place root = document.root();
    bool same = model.nodes.size() == root.elements("nodes").size() &&
                model.materials.size() == root.elements("materials").size() &&
                model.textures.size() == root.elements("textures").size();
    const std::vector<Place> meshes = root.elements("meshes");
    same = same && model.meshes.size() == meshes.size();
    for (std::size_t i = 0; same && i < meshes.size(); ++i)
        same = model.meshes[i].primitives.size() == meshes[i].get("primitives").size();
    if (!same) refuse("the JSON", "tinygltf could not read all of it");
    return model;
}

AnimationChannel channelOf(Document& document, const tinygltf::AnimationSampler& sampler,
                           AnimationPath path, std::size_t targets, Notes& notes) {
    AnimationChannel channel;
    channel.path = path;
    channel.interpolation = sampler.interpolation == "STEP"          ? Interpolation::step
                            : sampler.interpolation == "CUBICSPLINE" ? Interpolation::cubicSpline
                                                                     : Interpolation::linear;
    const auto input = static_cast<std::size_t>(sampler.input);
    const auto output = static_cast<std::size_t>(sampler.output);
    const std::vector<float> times = readFloats(document, input);
    const std::vector<float> values = readFloats(document, output);
    document.spend(values.size() * sizeof(glm::vec4), placeOf("accessors", output));
    const std::size_t components =
        path == AnimationPath::weights ? targets : document.accessors[output].components;
    const std::size_t perTime = channel.interpolation == Interpolation::cubicSpline ? 3 : 1;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!channel.times.empty() && times[i] <= channel.times.back()) {
            notes.count("{} animation keys are not after the one before: dropped");
            continue;
        }
        channel.times.push_back(times[i]);
        for (std::size_t k = i * perTime; k < (i + 1) * perTime; ++k) {
            if (path == AnimationPath::weights) {
                const auto run = values.begin() + static_cast<std::ptrdiff_t>(k * components);
                channel.weights.insert(channel.weights.end(), run,
                                       run + static_cast<std::ptrdiff_t>(components));
                continue;
            }
            glm::vec4 value(0);
            for (std::size_t component = 0; component < components; ++component)
                value[static_cast<int>(component)] = values[k * components + component];
            channel.values.push_back(value);
        }
    }
    return channel;
}

void noteExtensions(const Document& document, Notes& notes) {
    for (const Place& used : document.root().elements("extensionsUsed")) {
        if (used.text() == "KHR_materials_variants")
            notes.count("KHR_materials_variants: only the default materials are shown");
        else if (!isSupported(used.text()))
            notes.count(cleaned(used.text()) + ": not supported, left out");
    }
}

/// The box of all that is drawn, at rest and at the first moment of the animation.
void checkWorldBounds(const Scene& scene) {
    const Bounds bounds = worldBounds(scene, worldFromNode(scene));
    constexpr float kFarthest = 1e18f;
    const auto isNear = [](glm::vec3 p) {
        const glm::vec3 size = glm::abs(p);
        return size.x <= kFarthest && size.y <= kFarthest && size.z <= kFarthest;
    };
    const bool drawn = std::any_of(scene.instances.begin(), scene.instances.end(),
                                   [&](auto& i) { return !scene.meshes[i.mesh].bounds.empty(); });
    if (drawn && !(isNear(bounds.lower) && isNear(bounds.upper)))
        refuse("/nodes", "the bounds of the scene are not finite or too large");
}

Scene sceneFrom(Bytes bytes, const std::string& name, const std::filesystem::path& folder) {
    Document document = readDocument(bytes, folder);
    validate(document);
    const tinygltf::Model model = modelOf(document);
    Scene scene;
    scene.name = name;
    Notes notes;
    Conversion conversion{document, model, scene, notes};
    convertMaterials(conversion);
    convertNodes(conversion);
    if (conversion.usesDefaultMaterial) scene.materials.emplace_back().name = "default";
    checkWorldBounds(scene);
    noteExtensions(document, notes);
    if (scene.animations.size() > 1)
        notes.count(fmt::format("{} animations: only the first plays", scene.animations.size()));
    if (scene.instances.empty()) notes.count("no triangles to draw");
    scene.notes = notes.sentences();
    return scene;
}

Result<Scene> guarded(const std::string& name, const auto& import) {
    const auto refused = [&](const std::string& what) { return fail(cleaned(name) + ": " + what); };
    try {
        return import();
    } catch (const Refusal& refusal) {
        return refused(refusal.message);
    } catch (const std::bad_alloc&) {
        return refused("not enough memory for it; close other programs or export a smaller scene");
    } catch (const std::exception& error) {
        return refused(cleaned(error.what()) + "; export it again");
    }
}

}  // namespace

std::vector<std::string> Notes::sentences() const {
    std::vector<std::string> all;
    for (const auto& [what, number] : counts) {
        std::string sentence = what;
        const std::size_t slot = sentence.find("{}");
        if (slot != std::string::npos) sentence.replace(slot, 2, std::to_string(number));
        all.push_back(std::move(sentence));
    }
    return all;
}

void convertAnimations(Conversion& c, const std::vector<std::uint32_t>& sceneNodes) {
    for (const tinygltf::Animation& source : c.model.animations) {
        Animation animation;
        animation.name = cleaned(source.name);
        for (const tinygltf::AnimationChannel& channel : source.channels) {
            const std::string& path = channel.target_path;
            const bool morphs = path == "weights";
            const bool moves = path == "translation" || path == "rotation" || path == "scale";
            if (!moves && !morphs)
                c.notes.count(
                    "{} animation channels move neither a node's place nor its turn nor "
                    "its size nor its weights: left out");
            if ((!moves && !morphs) || channel.target_node < 0) continue;
            const std::uint32_t node = sceneNodes[static_cast<std::size_t>(channel.target_node)];
            if (node == kNone) continue;
            if (moves && c.scene.nodes[node].hasMatrix) {
                c.notes.count("{} animation channels target a node with a matrix: left out");
                continue;
            }
            const std::size_t targets = c.scene.nodes[node].weights.size();
            if (morphs && targets == 0) {
                c.notes.count("{} animation channels of weights that nothing has: left out");
                continue;
            }
            AnimationChannel converted =
                channelOf(c.document, source.samplers[static_cast<std::size_t>(channel.sampler)],
                          path == "translation" ? AnimationPath::translation
                          : path == "rotation"  ? AnimationPath::rotation
                          : path == "scale"     ? AnimationPath::scale
                                                : AnimationPath::weights,
                          targets, c.notes);
            if (converted.times.empty()) continue;
            converted.node = node;
            animation.duration = std::max(animation.duration, converted.times.back());
            animation.channels.push_back(std::move(converted));
        }
        if (!animation.channels.empty()) c.scene.animations.push_back(std::move(animation));
    }
}

}  // namespace gltf

Result<Scene> importGltfFromMemory(std::span<const std::uint8_t> bytes, const std::string& name,
                                   const std::filesystem::path& folder) {
    return gltf::guarded(name, [&] { return gltf::sceneFrom(bytes, name, folder); });
}

Result<Scene> importGltf(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    const std::filesystem::path folder =
        path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    return gltf::guarded(name, [&] {
        constexpr std::uint64_t kMostBytes = 0xffffffff;  // what a GLB can say of itself
        const std::vector<std::uint8_t> bytes = gltf::readFile(path, kMostBytes, path.string());
        return gltf::sceneFrom(bytes, name, folder);
    });
}

}  // namespace lodestar::scene
