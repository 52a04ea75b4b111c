// SPDX-License-Identifier: Apache-2.0
#include "app/cli.hpp"

#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "app/console.hpp"

namespace lodestar::app {

namespace {

constexpr int kLargestSide = 16384;  // what the floor driver can make an image of

/// The number `text` starts with and nothing else; none when there is more or less.
template <typename T>
std::optional<T> wholeNumber(std::string_view text) {
    T value{};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

Result<PictureSize> parseSize(const std::string& text) {
    const std::size_t cross = text.find('x');
    if (cross != std::string::npos) {
        const auto width = wholeNumber<int>(std::string_view(text).substr(0, cross));
        const auto height = wholeNumber<int>(std::string_view(text).substr(cross + 1));
        if (width && height && *width >= 1 && *height >= 1 && *width <= kLargestSide &&
            *height <= kLargestSide)
            return PictureSize{*width, *height};
    }
    return fail("'" + text + "' is no size: give WxH in pixels, each 1 to " +
                std::to_string(kLargestSide) + ", such as 1280x720");
}

Result<glm::vec3> parseVector(const std::string& text) {
    glm::vec3 vector{0};
    std::size_t begin = 0;
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = i < 2 ? text.find(',', begin) : text.size();
        if (comma == std::string::npos) break;
        const auto value = wholeNumber<float>(std::string_view(text).substr(begin, comma - begin));
        if (!value || !std::isfinite(*value)) break;
        vector[i] = *value;
        begin = comma + 1;
        if (i == 2) return vector;
    }
    return fail("'" + text + "' is no point: give three numbers X,Y,Z without spaces");
}

Result<double> parseNumber(const std::string& text) {
    const auto value = wholeNumber<double>(text);
    if (!value || !std::isfinite(*value)) return fail("'" + text + "' is not a number");
    return *value;
}

void addViewOptions(CLI::App& app, ViewOptions& view) {
    addParsed(app, "--size", view.size, parseSize, "output size in pixels")
        ->type_name("WxH")
        ->default_str("1280x720")
        ->group("View");
    CLI::Option* camera =
        app.add_option("--camera", view.camera,
                       "a camera of the scene (`lodestar inspect` lists them); without one the "
                       "view frames the whole scene")
            ->type_name("N|NAME")
            ->group("View");
    CLI::Option* eye = addParsed(app, "--eye", view.eye, parseVector, "look from this point")
                           ->type_name("X,Y,Z")
                           ->excludes(camera)
                           ->group("View");
    CLI::Option* at = addParsed(app, "--at", view.at, parseVector, "look at this point")
                          ->type_name("X,Y,Z")
                          ->needs(eye)
                          ->group("View");
    eye->needs(at);
    const auto parseFov = [](const std::string& text) -> Result<double> {
        const Result<double> degrees = parseNumber(text);
        if (degrees && *degrees > 0 && *degrees < 180) return degrees;
        return fail("'" + text + "' is no field of view: give degrees above 0 and below 180");
    };
    addParsed(app, "--fov", view.fovDegrees, parseFov, "vertical field of view in degrees")
        ->type_name("DEG")
        ->group("View");
    addParsed(app, "--orbit", view.orbitDegrees, parseNumber,
              "turn the camera about the point it looks at by this many degrees")
        ->type_name("DEG")
        ->group("View");
}

void addSceneArgument(CLI::App& app, std::string& scene) {
    app.add_option("SCENE", scene,
                   "glTF 2.0 (.gltf, .glb), another format (OBJ, PLY, …), or builtin:NAME "
                   "(`lodestar inspect builtin:` lists them)")
        ->type_name("")
        ->required();
}

void addDeviceOption(CLI::App& app, std::string& device) {
    app.add_option("--device", device, "Vulkan device (`lodestar info` lists them)")
        ->type_name("NAME|INDEX");
}

void addJsonOption(CLI::App& app, std::filesystem::path& file) {
    app.add_option("--json", file, "also write the results as data")->type_name("FILE");
}

int finish(const Result<void>& outcome) {
    if (outcome) return kExitOk;
    printError(outcome.error().message);
    return kExitFailure;
}

}  // namespace lodestar::app
