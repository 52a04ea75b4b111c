// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <glm/glm.hpp>

#include <lodestar/budget/budget.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;

struct PictureSize {
    int width = 1280, height = 720;
};

/// Reads "1280x720": both sides 1 … 16384.
Result<PictureSize> parseSize(const std::string& text);
/// Reads "X,Y,Z".
Result<glm::vec3> parseVector(const std::string& text);
/// Reads one finite number, all of `text`.
Result<double> parseNumber(const std::string& text);

/// An option read by `parse`, a function of the kind above. `target` must outlive the parsing. What
/// `parse` refuses is bad usage: one line and exit status 2.
template <typename T, typename Parse>
CLI::Option* addParsed(CLI::App& app, const std::string& name, T& target, Parse parse,
                       const std::string& description) {
    return app.add_option_function<std::string>(
        name,
        [&target, parse, name](const std::string& text) {
            const auto value = parse(text);
            if (!value) throw CLI::ValidationError(name, value.error().message);
            target = *value;
        },
        description);
}

/// Where the picture is taken from and how big it is: what render, view, capture and bench share.
struct ViewOptions {
    PictureSize size;
    std::string camera;  ///< number or name of a camera of the scene; empty = none given
    std::optional<glm::vec3> eye, at;
    std::optional<double> fovDegrees;  ///< vertical
    double orbitDegrees = 0;
};

/// Adds --size, --camera, --eye, --at, --fov and --orbit under the heading "View".
void addViewOptions(CLI::App&, ViewOptions&);
/// Adds the SCENE argument, required.
void addSceneArgument(CLI::App&, std::string& scene);
/// Adds --device.
void addDeviceOption(CLI::App&, std::string& device);
/// Adds --json.
void addJsonOption(CLI::App&, std::filesystem::path& file);

/// The exit status of a command that ended like this; prints the error line when it failed.
int finish(const Result<void>&);

}  // namespace lodestar::app
