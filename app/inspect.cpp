// SPDX-License-Identifier: Apache-2.0
#include "app/inspect.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include <lodestar/scene/import.hpp>
#include <lodestar/scene/mesh_lods.hpp>
#include <lodestar/scene/procedural.hpp>

#include "app/cli.hpp"
#include "app/console.hpp"

namespace lodestar::app {

namespace {

struct Options {
    std::string scene;
    double seconds = 0;
    std::filesystem::path json;
};

const char* nameOf(scene::ColorSpace space) {
    return space == scene::ColorSpace::srgb ? "sRGB" : "linear";
}

const char* nameOf(scene::LightKind kind) {
    switch (kind) {
        case scene::LightKind::directional:
            return "directional";
        case scene::LightKind::point:
            return "point";
        case scene::LightKind::spot:
            return "spot";
    }
    return "";
}

bool textured(const scene::Material& material) {
    for (const scene::TextureUse* use :
         {&material.baseColorTexture, &material.normalTexture, &material.metallicRoughnessTexture,
          &material.occlusionTexture, &material.emissiveTexture})
        if (use->texture != scene::kNone) return true;
    return false;
}

double degrees(float radians) {
    return double(radians) * 180 / glm::pi<double>();
}

std::string orUnnamed(const std::string& name) {
    return name.empty() ? "(no name)" : printable(name);
}

std::string point(glm::vec3 p) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z);
}

// What people read.

void printCounts(const scene::Scene& scene, const Inspection& found) {
    Table table({{"", Table::Align::left}, {"", Table::Align::right}, {"", Table::Align::left}});
    const auto line = [&](const char* what, std::uint64_t count, std::string remark = "") {
        table.row({what, formatCount(count), std::move(remark)});
    };
    const auto& kinds = found.materials;
    line("meshes", scene.meshes.size());
    line("triangles", found.triangles.stored, "stored, all at LOD 0");
    line("", found.triangles.drawn, "drawn by all instances");
    line("vertices", found.vertices);
    line("meshlets", found.meshletsStored,
         formatCount(found.meshletsDrawn) + " drawn by all instances");
    line("instances", scene.instances.size());
    line("nodes", scene.nodes.size());
    line("materials", scene.materials.size(),
         fmt::format("{} opaque, {} mask, {} blend; {} double-sided, {} unlit, {} textured",
                     kinds.opaque, kinds.mask, kinds.blend, kinds.doubleSided, kinds.unlit,
                     kinds.textured));
    line("textures", scene.textures.size(), fmt::format("of {} images", scene.images.size()));
    line("cameras", scene.cameras.size());
    line("lights", scene.lights.size());
    line("animations", scene.animations.size());
    const auto deforming = std::count_if(scene.instances.begin(), scene.instances.end(),
                                         [&](auto& i) { return scene::deforms(scene, i); });
    if (deforming > 0)
        line("deforming", static_cast<std::uint64_t>(deforming),
             fmt::format("of the instances: by joints or morph weights; {} skins",
                         scene.skins.size()));
    std::cout << printable(scene.name) << '\n' << table.text();
}

void printBounds(const scene::Bounds& bounds) {
    if (bounds.empty()) {
        std::cout << "\nbounds: none, the scene has no triangles\n";
        return;
    }
    std::cout << fmt::format("\nbounds {} to {}, radius {:.4g} scene units\n", point(bounds.lower),
                             point(bounds.upper), bounds.radius());
}

void printLists(const scene::Scene& scene) {
    if (!scene.cameras.empty()) {
        Table table(
            {{"", Table::Align::right}, {"", Table::Align::left}, {"", Table::Align::left}});
        for (std::size_t i = 0; i < scene.cameras.size(); ++i)
            table.row({std::to_string(i), orUnnamed(scene.cameras[i].name),
                       fmt::format("{:.1f}° vertical", degrees(scene.cameras[i].verticalFov))});
        std::cout << "\ncameras\n" << table.text();
    }
    if (!scene.lights.empty()) {
        Table table({{"", Table::Align::left}, {"", Table::Align::left}, {"", Table::Align::left}});
        for (const scene::Light& light : scene.lights)
            table.row({orUnnamed(light.name), nameOf(light.kind),
                       fmt::format("{:.4g} {}", light.intensity,
                                   light.kind == scene::LightKind::directional ? "lx" : "cd")});
        std::cout << "\nlights\n" << table.text();
    }
    if (!scene.animations.empty()) {
        Table table(
            {{"", Table::Align::left}, {"", Table::Align::right}, {"", Table::Align::right}});
        for (const scene::Animation& animation : scene.animations)
            table.row({orUnnamed(animation.name), fmt::format("{:.2f} s", animation.duration),
                       fmt::format("{} channels", animation.channels.size())});
        std::cout << "\nanimations\n" << table.text();
    }
}

void printMemory(const Inspection& found) {
    if (!found.textureArrays.empty()) {
        Table table({{"size", Table::Align::right},
                     {"layers", Table::Align::right},
                     {"mips", Table::Align::right},
                     {"encoding", Table::Align::left},
                     {"memory", Table::Align::right}});
        for (const Inspection::Layers& array : found.textureArrays)
            table.row({fmt::format("{}x{}", array.width, array.height),
                       std::to_string(array.layers), std::to_string(array.mipLevels),
                       nameOf(array.space), formatBytes(array.bytes)});
        std::cout << "\ntexture arrays\n" << table.text();
    }
    Table table({{"", Table::Align::left}, {"", Table::Align::right}});
    std::uint64_t sum = 0;
    for (const MemoryUse& use : found.memory) {
        table.row({use.resource, formatBytes(use.bytes)});
        sum += use.bytes;
    }
    table.row({"total", formatBytes(sum)});
    std::cout << "\nmemory on the device (estimate)\n" << table.text();
}

// The same as data.

Json vectorJson(glm::vec3 v) {
    return Json::array({v.x, v.y, v.z});
}

Json countsJson(const scene::Scene& scene, const Inspection& found) {
    Json perLod = Json::array();
    for (const Inspection::Level& level : found.levels) perLod.push_back(level.stored);
    return {{"meshes", scene.meshes.size()},
            {"triangles_stored", found.triangles.stored},
            {"triangles_drawn", found.triangles.drawn},
            {"triangles_per_lod", perLod},
            {"vertices", found.vertices},
            {"meshlets_stored", found.meshletsStored},
            {"meshlets_drawn", found.meshletsDrawn},
            {"instances_total", scene.instances.size()},
            {"nodes", scene.nodes.size()},
            {"materials", scene.materials.size()},
            {"materials_opaque", found.materials.opaque},
            {"materials_mask", found.materials.mask},
            {"materials_blend", found.materials.blend},
            {"materials_double_sided", found.materials.doubleSided},
            {"materials_unlit", found.materials.unlit},
            {"materials_textured", found.materials.textured},
            {"textures", scene.textures.size()},
            {"images", scene.images.size()},
            {"cameras", scene.cameras.size()},
            {"lights", scene.lights.size()},
            {"animations", scene.animations.size()}};
}

Json detailsJson(const scene::Scene& scene, const Inspection& found) {
    Json arrays = Json::array(), cameras = Json::array(), lights = Json::array(),
         animations = Json::array(), bounds;
    for (const Inspection::Layers& array : found.textureArrays)
        arrays.push_back({{"width", array.width},
                          {"height", array.height},
                          {"layers", array.layers},
                          {"mip_levels", array.mipLevels},
                          {"encoding", nameOf(array.space)},
                          {"bytes", array.bytes}});
    for (const scene::SceneCamera& camera : scene.cameras)
        cameras.push_back({{"name", camera.name}, {"fov_deg", degrees(camera.verticalFov)}});
    for (const scene::Light& light : scene.lights)
        lights.push_back(
            {{"name", light.name}, {"kind", nameOf(light.kind)}, {"intensity", light.intensity}});
    for (const scene::Animation& animation : scene.animations)
        animations.push_back({{"name", animation.name},
                              {"duration_s", animation.duration},
                              {"channels", animation.channels.size()}});
    if (!found.bounds.empty())
        bounds = {{"lower", vectorJson(found.bounds.lower)},
                  {"upper", vectorJson(found.bounds.upper)},
                  {"radius", found.bounds.radius()}};
    return {{"bounds", bounds}, {"texture_arrays", arrays}, {"cameras", cameras},
            {"lights", lights}, {"animations", animations}, {"notes", scene.notes}};
}

/// Triangles and errors level by level.
std::vector<Inspection::Level> levelsOf(const scene::Scene& scene,
                                        const std::vector<scene::MeshLods>& chains) {
    std::vector<std::uint64_t> uses(chains.size());
    for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh];
    std::vector<Inspection::Level> levels;
    for (std::size_t level = 0;; ++level) {
        Inspection::Level sum;
        std::vector<float> errors;
        for (std::size_t i = 0; i < chains.size(); ++i) {
            const auto& own = chains[i].levels;
            const scene::MeshLod& lod = own[std::min(level, own.size() - 1)];
            sum.stored += lod.meshlets.triangles.size();
            sum.drawn += uses[i] * lod.meshlets.triangles.size();
            if (level >= own.size()) continue;
            ++sum.meshes;
            ++sum.methods[static_cast<std::size_t>(lod.method)];
            const float radius = scene.meshes[i].bounds.radius();
            errors.push_back(radius > 0 ? lod.error / radius : 0);
        }
        if (sum.meshes == 0) return levels;
        std::nth_element(errors.begin(), errors.begin() + std::ptrdiff_t(errors.size() / 2),
                         errors.end());
        sum.error = errors[errors.size() / 2];
        levels.push_back(sum);
    }
}

void printLevels(const Inspection& found) {
    if (found.levels.size() < 2) return;
    constexpr auto kRight = Table::Align::right;
    Table table({{"level", kRight},
                 {"meshes", kRight},
                 {"triangles", kRight},
                 {"drawn", kRight},
                 {"error / radius", kRight},
                 {"made by"}});
    for (std::size_t i = 0; i < found.levels.size(); ++i) {
        const Inspection::Level& level = found.levels[i];
        std::string methods;
        for (std::size_t m = 0; m < level.methods.size(); ++m)
            if (level.methods[m] > 0)
                methods +=
                    fmt::format("{}{} {}", methods.empty() ? "" : ", ",
                                formatCount(level.methods[m]), scene::nameOf(scene::LodMethod(m)));
        table.row({std::to_string(i), formatCount(level.meshes), formatCount(level.stored),
                   formatCount(level.drawn), fmt::format("{:.2g}", level.error), methods});
    }
    std::cout << "\nlevels of detail\n" << table.text();
}

Json levelsJson(const Inspection& found) {
    Json levels = Json::array();
    for (const Inspection::Level& level : found.levels) {
        Json methods;
        for (std::size_t m = 0; m < level.methods.size(); ++m)
            methods[scene::nameOf(scene::LodMethod(m))] = level.methods[m];
        levels.push_back({{"meshes", level.meshes},
                          {"triangles_stored", level.stored},
                          {"triangles_drawn", level.drawn},
                          {"error_per_radius", level.error},
                          {"methods", methods}});
    }
    return levels;
}

Result<void> listBuiltins(const Options& options) {
    Table table({{"", Table::Align::left}, {"", Table::Align::left}});
    Json list = Json::array();
    for (const scene::Builtin& builtin : scene::builtins()) {
        table.row({"builtin:" + builtin.usage, builtin.description});
        list.push_back(
            {{"scene", "builtin:" + builtin.usage}, {"description", builtin.description}});
    }
    std::cout << "procedural scenes\n" << table.text();
    if (options.json.empty()) return {};
    Report report;
    report.scene = options.scene;
    report.more = {{"builtins", list}};
    return writeJson(options.json, toJson(report));
}

Result<void> inspect(const Options& options) {
    if (options.scene == "builtin:") return listBuiltins(options);
    const Result<scene::Scene> loaded = scene::load(options.scene);
    if (!loaded) return tl::unexpected(loaded.error());
    const Inspection found = inspectScene(*loaded, options.seconds);

    printCounts(*loaded, found);
    printBounds(found.bounds);
    printLevels(found);
    printLists(*loaded);
    printMemory(found);
    if (!loaded->notes.empty()) std::cout << "\nnotes\n";
    for (const std::string& note : loaded->notes) std::cout << "  " << printable(note) << '\n';

    if (options.json.empty()) return {};
    Report report;
    report.scene = options.scene;
    report.settings = {{"seconds", options.seconds}};
    report.counts = countsJson(*loaded, found);
    report.memory = found.memory;
    report.more = detailsJson(*loaded, found);
    report.more["levels_of_detail"] = levelsJson(found);
    return writeJson(options.json, toJson(report));
}

}  // namespace

Inspection inspectScene(const scene::Scene& scene, double seconds) {
    Inspection found;
    found.triangles = scene::countTriangles(scene);
    found.bounds = scene::worldBounds(scene, scene::poseAt(scene, float(seconds)));

    for (const scene::Material& material : scene.materials) {
        auto& kinds = found.materials;
        kinds.opaque += material.alphaMode == scene::AlphaMode::opaque;
        kinds.mask += material.alphaMode == scene::AlphaMode::mask;
        kinds.blend += material.alphaMode == scene::AlphaMode::blend;
        kinds.doubleSided += material.doubleSided;
        kinds.unlit += material.unlit;
        kinds.textured += textured(material);
    }

    std::vector<std::uint64_t> meshletsOf;
    std::uint64_t indexBytes = 0, meshletBytes = 0;
    {
        Progress progress("levels of detail", scene.meshes.size());
        const auto chains = scene::buildSceneLods(
            scene, {.cache = scene::userCacheFolder()},
            [&](int done, int) { progress.update(static_cast<std::size_t>(done)); });
        for (std::size_t i = 0; i < chains.size(); ++i) {
            meshletsOf.push_back(chains[i].levels[0].meshlets.meshlets.size());
            found.vertices += scene.meshes[i].vertices.size();
            found.meshletsStored += meshletsOf.back();
            for (const scene::MeshLod& lod : chains[i].levels) {
                indexBytes += lod.meshlets.triangles.size() * 16;
                meshletBytes += lod.meshlets.meshlets.size() * sizeof(scene::Meshlet);
            }
        }
        found.levels = levelsOf(scene, chains);
    }
    for (const scene::Instance& instance : scene.instances)
        found.meshletsDrawn += meshletsOf[instance.mesh];

    std::uint64_t textureBytes = 0;
    for (const scene::TextureArray& array : scene::buildTextureArrays(scene).arrays) {
        found.textureArrays.push_back({array.width, array.height, array.layers, array.mipLevels,
                                       array.space, array.texels.size()});
        textureBytes += array.texels.size();
    }
    // An instance is its two matrices, world from object and that of normals.
    found.memory = {{"vertices", found.vertices * sizeof(scene::Vertex)},
                    {"indices", indexBytes},
                    {"meshlets", meshletBytes},
                    {"instances", scene.instances.size() * 2 * sizeof(glm::mat4)},
                    {"textures", textureBytes}};
    return found;
}

void addInspect(CLI::App& app, int& exitCode) {
    CLI::App* command = app.add_subcommand("inspect", "what is in a scene file");
    const auto options = std::make_shared<Options>();
    addSceneArgument(*command, options->scene);
    const auto parseSeconds = [](const std::string& text) -> Result<double> {
        const Result<double> seconds = parseNumber(text);
        if (seconds && *seconds >= 0) return seconds;
        return fail("'" + text + "' is no time: give seconds from 0 up");
    };
    addParsed(*command, "--seconds", options->seconds, parseSeconds,
              "time of the first animation at which the bounds are taken")
        ->type_name("T")
        ->default_str("0");
    addJsonOption(*command, options->json);
    command->footer(
        "Examples:\n"
        "  lodestar inspect model.glb\n"
        "  lodestar inspect model.glb --json model.json\n"
        "  lodestar inspect builtin:               the procedural scenes there are");
    command->callback([options, &exitCode] { exitCode = finish(inspect(*options)); });
}

}  // namespace lodestar::app
