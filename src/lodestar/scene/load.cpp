// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>

#include <lodestar/scene/import.hpp>
#include <lodestar/scene/procedural.hpp>

namespace lodestar::scene {

Result<Scene> load(const std::string& source) {
    constexpr std::string_view kBuiltin = "builtin:";
    if (source.starts_with(kBuiltin)) return buildBuiltin(source.substr(kBuiltin.size()));

    const std::filesystem::path path(source);
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found)
        return fail(source + ": no such file");
    if (status.type() == std::filesystem::file_type::directory)
        return fail(source + ": is a folder; name a model file in it (.gltf, .glb, .obj, …)");
    // A pipe or a device may never end, and importers seek.
    if (status.type() != std::filesystem::file_type::regular)
        return fail(source + ": cannot be read as a file" +
                    (error ? " (" + error.message() + ")" : std::string()));

    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".gltf" || extension == ".glb" ? importGltf(path) : importAssimp(path);
}

}  // namespace lodestar::scene
