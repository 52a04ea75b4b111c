// SPDX-License-Identifier: Apache-2.0
#include "app/bench/visibility_cases.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "app/console.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kThesis =
#include "app/bench/thesis.json.inc"
    ;

}  // namespace

const Json& thesis() {
    static const Json json = Json::parse(kThesis);
    return json;
}

bool isQuick(const BenchOptions& options) {
    return options.view.size.width <= 240;
}

std::vector<NamedSize> sizesUpTo(const BenchOptions& options, const std::string& most) {
    if (isQuick(options)) return {{"qHD/4", 240, 136}};
    const PictureSize asked = options.view.size, usual;
    if (asked.width != usual.width || asked.height != usual.height) {
        const auto width = static_cast<std::uint32_t>(asked.width);
        const auto height = static_cast<std::uint32_t>(asked.height);
        const char* name = width == 960     ? "qHD"
                           : width == 1920  ? "FHD"
                           : width == 3840  ? "UHD"
                           : width == 7680  ? "8K"
                           : width == 15360 ? "16K"
                                            : "other";
        return {{name, width, height}};
    }
    std::vector<NamedSize> sizes;
    for (const NamedSize& size :
         {NamedSize{"qHD", 960, 540}, NamedSize{"FHD", 1920, 1080}, NamedSize{"UHD", 3840, 2160},
          NamedSize{"8K", 7680, 4320}, NamedSize{"16K", 15360, 8640}}) {
        sizes.push_back(size);
        if (most == size.name) break;
    }
    return sizes;
}

Result<std::vector<BenchCase>> visibilityCases(const BenchOptions& options) {
    if (!options.scene.empty()) return benchCases(options, {});
    auto cases =
        benchCases(options, {{"sponza.glb", "nave", ""}, {"city_kaykit.glb", "street", ""}});
    if (cases) cases->push_back({"builtin:grid:10000000", "above", ""});
    return cases;
}

Result<VisibilitySubject> openSubject(const BenchCase& what, const BenchOptions& options) {
    auto session = openSession(what.scene, options.device);
    if (!session) return tl::unexpected(session.error());
    ViewOptions view = options.view;
    view.camera = what.camera;
    const auto camera = resolveCamera(*session, view);
    if (!camera) return tl::unexpected(camera.error());
    VisibilitySubject subject{.session = std::move(*session),
                              .camera = *camera,
                              .name = std::filesystem::path(what.scene).filename().string()};
    subject.triangles = subject.session.gpuScene->triangleCount();
    fmt::print("{}: {} triangles, on {}\n", printable(what.scene), formatCount(subject.triangles),
               subject.session.device->description().name);
    return subject;
}

Json visibilityRow(const char* measures, const VisibilitySubject& subject, const NamedSize& size,
                   const std::string& method, std::uint32_t side) {
    return {{"measures", measures}, {"scene", subject.name},      {"triangles", subject.triangles},
            {"size", size.name},    {"width", size.width},        {"height", size.height},
            {"method", method},     {"capture_rate", side * side}};
}

double share(std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
}

}  // namespace lodestar::app
