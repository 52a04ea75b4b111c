// SPDX-License-Identifier: Apache-2.0
#include "app/session.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/import.hpp>

#include "app/console.hpp"

namespace lodestar::app {
namespace {

float radians(double degrees) {
    return static_cast<float>(glm::radians(degrees));
}

std::string listNames(const std::vector<scene::SceneCamera>& cameras) {
    if (cameras.empty()) return "the scene has none";
    std::string names;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        names +=
            fmt::format("{}{}: {}", i == 0 ? "there is " : ", ", i, printable(cameras[i].name));
    return names;
}

glm::vec3 vectorOf(const Json& json) {
    return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()};
}

/// A view called `name` in the `views.json` beside the scene file; none when there is no such file,
/// scene or view.
std::optional<scene::Camera> namedView(const std::string& sceneName, const std::string& name) {
    const std::filesystem::path path(sceneName);
    std::ifstream file(path.parent_path() / "views.json");
    if (!file) return std::nullopt;
    const Json views = Json::parse(file, nullptr, false);
    const auto scene = views.find(path.filename().string());
    if (views.is_discarded() || scene == views.end() || !scene->contains(name)) return std::nullopt;
    try {
        const Json& view = scene->at(name);
        return scene::Camera{.eye = vectorOf(view.at("eye")),
                             .at = vectorOf(view.at("at")),
                             .verticalFov = radians(view.at("fov_deg").get<double>())};
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

std::optional<std::size_t> findCamera(const scene::Scene& scene, const std::string& wanted) {
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
        if (scene.cameras[i].name == wanted || std::to_string(i) == wanted) return i;
    return std::nullopt;
}

}  // namespace

Result<Session> openSession(const std::string& sceneName, const gpu::DeviceRequest& request,
                            bool opaque) {
    Session session{.sceneName = sceneName};
    auto loaded = scene::load(sceneName);
    if (!loaded) return tl::unexpected(loaded.error());
    for (scene::Material& material : loaded->materials)
        if (opaque && material.alphaMode == scene::AlphaMode::blend)
            material.alphaMode = scene::AlphaMode::opaque;
    session.scene = std::make_unique<const scene::Scene>(std::move(*loaded));
    for (const std::string& note : session.scene->notes) fmt::print("note: {}\n", printable(note));
    session.device = std::make_unique<gpu::Device>(request);
    {
        std::optional<Progress> bar;
        session.gpuScene = std::make_unique<scene::GpuScene>(
            *session.device, *session.scene,
            [&](const char* what, int done, int of) {
                if (done == 0) bar.emplace(what, static_cast<std::size_t>(of));
                bar->update(static_cast<std::size_t>(done));
            },
            scene::LodSettings{.cache = scene::userCacheFolder()});
    }
    return session;
}

Result<scene::Camera> resolveCamera(const Session& session, const ViewOptions& options) {
    const auto& [sceneName, scene, device, gpuScene] = session;
    const float aspect =
        static_cast<float>(options.size.width) / static_cast<float>(options.size.height);
    const scene::Bounds& bounds = gpuScene->bounds();
    scene::Camera camera = scene::frame(bounds, aspect);
    const float nearPlane = camera.nearPlane;
    if (options.eye) {
        camera.eye = *options.eye;
        camera.at = *options.at;
        if (camera.eye == camera.at) return fail("--eye and --at are the same point: move one");
    } else if (!options.camera.empty()) {
        if (const auto index = findCamera(*scene, options.camera)) {
            const scene::SceneCamera& chosen = scene->cameras[*index];
            camera = scene::fromSceneCamera(chosen, gpuScene->nodeTransforms()[chosen.node],
                                            bounds.radius());
        } else if (const auto view = namedView(sceneName, options.camera)) {
            camera = *view;
            camera.nearPlane = nearPlane;
        } else {
            return fail(fmt::format("no camera '{}' in {}: {}", printable(options.camera),
                                    printable(sceneName), listNames(scene->cameras)));
        }
    }
    if (options.fovDegrees) camera.verticalFov = radians(*options.fovDegrees);
    if (options.orbitDegrees != 0)
        camera = scene::orbited(camera, camera.at, radians(options.orbitDegrees));
    return camera;
}

quality::RgbImage readDisplay(const gpu::Device& device, const frame::Frame& frame) {
    const vk::Extent2D extent = frame.display().extent();
    const auto rgba = gpu::readImage(device, frame.display());
    quality::RgbImage image(static_cast<int>(extent.width), static_cast<int>(extent.height));
    for (std::size_t i = 0; i < rgba.size() / 4; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            image.rgb[3 * i + c] = static_cast<std::uint8_t>(rgba[4 * i + c]);
    return image;
}

void describeDevice(const Session& session, Report& report) {
    report.device = session.device->description().name;
    report.driver = session.device->description().driver;
    report.scene = session.sceneName;
    for (const gpu::Allocation& allocation : session.device->allocations())
        report.memory.push_back({allocation.resource, allocation.bytes, false});
    report.peakBytes = session.device->peakBytes();
}

budget::FrameCosts costsOf(const gpu::FrameTimes& times) {
    budget::FrameCosts costs{.gpuMs = times.gpuMs, .passes = {}, .intervalMs = times.wallMs};
    for (const gpu::PassTime& pass : times.passes) costs.passes.push_back({pass.name, pass.ms});
    return costs;
}

}  // namespace lodestar::app
