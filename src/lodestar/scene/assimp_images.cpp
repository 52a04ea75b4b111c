// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/assimp_images.hpp>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <system_error>
#include <vector>

#include <assimp/scene.h>
#include <fmt/format.h>

#include <lodestar/scene/decode_image.hpp>
#include <lodestar/scene/mipmaps.hpp>

namespace lodestar::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFileBytes = 512u << 20;

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// `name` in `folder`, in any case: models made on Windows are careless about it.
fs::path anyCase(const fs::path& folder, const fs::path& name) {
    std::error_code error;
    const std::string wanted = lower(name.string());
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
        if (lower(entry.path().filename().string()) == wanted) return entry.path();
    return {};
}

/// The file a model means: the path beside the model, or else the bare name there (paths of the
/// author's own machine are common).
fs::path locate(const fs::path& folder, std::string reference) {
    std::ranges::replace(reference, '\\', '/');
    const fs::path named(reference);
    const bool foreign = named.is_absolute() || (reference.size() > 1 && reference[1] == ':');
    std::error_code error;
    for (const fs::path& path : {foreign ? fs::path() : folder / named, folder / named.filename()})
        if (!path.empty() && fs::is_regular_file(path, error)) return path;
    const fs::path found = anyCase(folder, named.filename());
    return fs::is_regular_file(found, error) ? found : fs::path();
}

Result<std::vector<std::uint8_t>> readFile(const fs::path& path) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) return fail(error.message());
    if (size > kMaxFileBytes) return fail(fmt::format("{} MiB is too large", size >> 20));
    std::vector<std::uint8_t> bytes(size);
    std::ifstream stream(path, std::ios::binary);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!stream) return fail("cannot be read");
    return bytes;
}

Result<Image> decodeEmbedded(const std::string& name, const aiTexture& texture) {
    if (texture.pcData == nullptr) return fail("is empty");
    if (texture.mHeight == 0)
        return decodeImage(name,
                           {reinterpret_cast<const std::uint8_t*>(texture.pcData), texture.mWidth});
    if (const auto allowed = checkImageSize(texture.mWidth, texture.mHeight); !allowed)
        return tl::unexpected(allowed.error());
    Image image{name, static_cast<int>(texture.mWidth), static_cast<int>(texture.mHeight), {}};
    const std::size_t texels = std::size_t(texture.mWidth) * texture.mHeight;
    image.rgba.reserve(4 * texels);
    for (std::size_t i = 0; i < texels; ++i) {
        const aiTexel& t = texture.pcData[i];
        image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
    }
    return image;
}

/// One value a texel: alpha where the image has any transparency, else the mean of the colours.
std::vector<std::uint8_t> scalars(const Image& image, int width, int height) {
    const bool fits = image.width == width && image.height == height;
    const std::vector<std::uint8_t> rgba =
        fits ? image.rgba
             : resized(image, width, height, ColorSpace::linear, Wrap::repeat, Wrap::repeat, false);
    bool alpha = false;
    for (std::size_t i = 3; i < rgba.size(); i += 4) alpha |= rgba[i] != 255;
    std::vector<std::uint8_t> values;
    values.reserve(rgba.size() / 4);
    for (std::size_t i = 0; i < rgba.size(); i += 4)
        values.push_back(
            alpha ? rgba[i + 3]
                  : static_cast<std::uint8_t>((rgba[i] + rgba[i + 1] + rgba[i + 2]) / 3));
    return values;
}

}  // namespace

Result<Image> AssimpImages::read(const std::string& reference) const {
    if (const aiTexture* embedded = from.GetEmbeddedTexture(reference.c_str()))
        return decodeEmbedded(reference, *embedded);
    const fs::path path = locate(folder, reference);
    if (path.empty()) return fail("is not beside the model");
    return readFile(path).and_then([&](const std::vector<std::uint8_t>& bytes) {
        return decodeImage(path.filename().string(), bytes);
    });
}

std::optional<std::uint32_t> AssimpImages::find(const std::string& reference) {
    const auto [entry, added] = known.try_emplace(reference);
    if (added) {
        Result<Image> image = read(reference);
        if (image)
            entry->second = add(std::move(*image));
        else
            scene.notes.push_back(
                fmt::format("texture '{}' {}: left out", reference, image.error().message));
    }
    return entry->second;
}

std::uint32_t AssimpImages::add(Image image) {
    scene.images.push_back(std::move(image));
    return static_cast<std::uint32_t>(scene.images.size() - 1);
}

std::uint32_t AssimpImages::withAlpha(std::optional<std::uint32_t> color, std::uint32_t opacity) {
    const auto [entry, added] = combined.try_emplace({0, color.value_or(kNone), opacity});
    if (!added) return entry->second;
    const Image& mask = scene.images[opacity];
    Image result = color ? scene.images[*color] : mask;
    if (color)
        result.name += " + " + mask.name;
    else
        std::ranges::fill(result.rgba, std::uint8_t(255));
    const std::vector<std::uint8_t> alpha = scalars(mask, result.width, result.height);
    for (std::size_t i = 0; i < alpha.size(); ++i) result.rgba[4 * i + 3] = alpha[i];
    return entry->second = add(std::move(result));
}

std::uint32_t AssimpImages::metallicRoughness(std::optional<std::uint32_t> metallic,
                                              std::optional<std::uint32_t> roughness) {
    const auto [entry, added] =
        combined.try_emplace({1, metallic.value_or(kNone), roughness.value_or(kNone)});
    if (!added) return entry->second;
    Image result;
    for (const auto& source : {metallic, roughness})
        if (source) {
            result.name += (result.name.empty() ? "" : " + ") + scene.images[*source].name;
            result.width = std::max(result.width, scene.images[*source].width);
            result.height = std::max(result.height, scene.images[*source].height);
        }
    result.rgba.assign(std::size_t(result.width) * std::size_t(result.height) * 4, 255);
    const auto fill = [&](std::optional<std::uint32_t> source, std::size_t channel) {
        if (!source) return;
        const std::vector<std::uint8_t> values =
            scalars(scene.images[*source], result.width, result.height);
        for (std::size_t i = 0; i < values.size(); ++i) result.rgba[4 * i + channel] = values[i];
    };
    fill(roughness, 1);
    fill(metallic, 2);
    return entry->second = add(std::move(result));
}

bool AssimpImages::looksLikeNormals(std::uint32_t image) const {
    const std::vector<std::uint8_t>& rgba = scene.images[image].rgba;
    double sum[3] = {0, 0, 0};
    for (std::size_t i = 0; i < rgba.size(); i += 4)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += rgba[i + c];
    const double texels = static_cast<double>(rgba.size() / 4);
    return sum[2] > 180 * texels && sum[2] > 1.3 * sum[0] && sum[2] > 1.3 * sum[1];
}

}  // namespace lodestar::scene
