// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include <lodestar/scene/scene.hpp>
#include <lodestar/shared/result.hpp>

struct aiScene;
struct aiTexture;

namespace lodestar::scene {

/// The images that an assimp scene names: embedded ones, and files beside the model. Each is read
/// once. One that is missing or unreadable becomes a note, and its use is dropped: many models
/// travel without some of theirs.
class AssimpImages {
public:
    /// Reads from `from` and `folder`; adds images and notes to `scene`.
    AssimpImages(const aiScene& from, std::filesystem::path folder, Scene& scene)
        : from(from), folder(std::move(folder)), scene(scene) {}

    /// Index of the image that the model calls `reference`.
    std::optional<std::uint32_t> find(const std::string& reference);

    /// `color` (white where there is none) with the scalar image `opacity` as its alpha.
    std::uint32_t withAlpha(std::optional<std::uint32_t> color, std::uint32_t opacity);
    /// A metallic-roughness image of two scalar ones; where there is none, 1.
    std::uint32_t metallicRoughness(std::optional<std::uint32_t> metallic,
                                    std::optional<std::uint32_t> roughness);
    /// Whether an image holds tangent-space normals and not heights: mostly blue, around (½, ½, 1).
    bool looksLikeNormals(std::uint32_t image) const;

private:
    Result<Image> read(const std::string& reference) const;
    std::uint32_t add(Image image);

    const aiScene& from;
    std::filesystem::path folder;
    Scene& scene;
    std::map<std::string, std::optional<std::uint32_t>> known;
    std::map<std::tuple<int, std::uint32_t, std::uint32_t>, std::uint32_t> combined;
};

}  // namespace lodestar::scene
