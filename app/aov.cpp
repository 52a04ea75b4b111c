// SPDX-License-Identifier: Apache-2.0
#include "app/aov.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include <glm/gtc/packing.hpp>

#include <lodestar/shared/octahedral.h>
#include <lodestar/gpu/readback.hpp>

#include "app/image_io.hpp"

namespace lodestar::app {
namespace {

constexpr std::array kNames{"depth", "normal", "albedo", "roughness", "metallic", "occlusion",
                            "id",    "shadow", "ao",     "ssao",      "motion"};

/// What a picture's pixels are made of, read back once.
struct Planes {
    std::vector<float> depth;
    std::vector<std::uint32_t> normal, ids;
    std::vector<glm::uvec4> material;
    std::vector<std::uint64_t> terms;
    std::vector<glm::vec4> motion;  ///< of pictures that have it
};

/// `value(i)` for every pixel, one channel for each of its components; 0 on the background.
template <typename Vector>
std::vector<ExrChannel> channels(const Planes& planes, const std::vector<std::string>& names,
                                 const std::function<Vector(std::size_t)>& value) {
    std::vector<ExrChannel> result;
    for (const std::string& name : names)
        result.push_back({name, std::vector<float>(planes.depth.size())});
    for (std::size_t i = 0; i < planes.depth.size(); ++i) {
        if (planes.ids[i] == 0) continue;
        const Vector v = value(i);
        for (std::size_t c = 0; c < names.size(); ++c)
            result[c].values[i] = v[static_cast<glm::length_t>(c)];
    }
    return result;
}

using glm::vec1;
using glm::vec2;
using glm::vec3;

std::vector<ExrChannel> makeAov(const Planes& p, const std::string& name) {
    const auto material = [&](std::size_t i, glm::length_t word) {
        return glm::unpackUnorm4x8(p.material[i][word]);
    };
    const std::vector<std::string> one{"Y"}, rgb{"R", "G", "B"}, xyz{"X", "Y", "Z"};
    if (name == "depth") return channels<vec1>(p, one, [&](auto i) { return vec1(p.depth[i]); });
    if (name == "normal")
        return channels<vec3>(p, xyz, [&](auto i) { return shared::unpackNormal(p.normal[i]); });
    if (name == "albedo")
        return channels<vec3>(p, rgb, [&](auto i) {
            const vec3 root(material(i, 0));
            return root * root;
        });
    if (name == "occlusion")
        return channels<vec1>(p, one, [&](auto i) { return vec1(material(i, 0).w); });
    if (name == "roughness")
        return channels<vec1>(p, one, [&](auto i) { return vec1(material(i, 1).x); });
    if (name == "metallic")
        return channels<vec1>(p, one, [&](auto i) { return vec1(material(i, 1).y); });
    if (name == "motion")
        return channels<vec2>(p, {"X", "Y"}, [&](auto i) { return vec2(p.motion[i]); });
    if (name == "shadow")
        return channels<vec1>(p, one,
                              [&](auto i) { return vec1(glm::unpackHalf4x16(p.terms[i]).x); });
    if (name == "ao")
        return channels<vec1>(p, one,
                              [&](auto i) { return vec1(glm::unpackHalf4x16(p.terms[i]).y); });
    if (name == "ssao")  // as "ao": the share that is seen
        return channels<vec1>(p, one,
                              [&](auto i) { return vec1(1 - glm::unpackHalf4x16(p.terms[i]).w); });
    return channels<vec1>(p, one, [&](auto i) { return vec1(static_cast<float>(p.ids[i])); });
}

}  // namespace

Result<std::vector<std::string>> parseAovs(const std::string& text) {
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string name = text.substr(begin, end - begin);
        if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
            std::string list;
            for (const char* known : kNames) list += std::string(list.empty() ? "" : ", ") + known;
            return fail("'" + name + "' is no AOV: one of " + list);
        }
        names.push_back(name);
        begin = end + 1;
    }
    return names;
}

void keepForAovs(const std::vector<std::string>& names, frame::FrameSettings& settings) {
    for (const std::string& name : names) {
        settings.motion = settings.motion || name == "motion";
        settings.keepTerms =
            settings.keepTerms || name == "shadow" || name == "ao" || name == "ssao";
    }
}

Result<std::vector<std::filesystem::path>> writeAovs(const gpu::Device& device,
                                                     const frame::Frame& frame,
                                                     const std::vector<std::string>& names,
                                                     const std::filesystem::path& out) {
    Planes planes{.depth = gpu::as<float>(gpu::readImage(device, frame.depth())),
                  .normal = gpu::as<std::uint32_t>(gpu::readImage(device, frame.normal())),
                  .ids = gpu::as<std::uint32_t>(gpu::readImage(device, frame.ids())),
                  .material = gpu::as<glm::uvec4>(gpu::readImage(device, frame.material())),
                  .terms = gpu::as<std::uint64_t>(gpu::readImage(device, frame.terms()))};
    const vk::Extent2D size = frame.grid();
    if (frame.settings().motion) {
        // In pixels: what people look for in the file.
        planes.motion = gpu::as<glm::vec4>(gpu::readImage(device, frame.motion()));
        for (glm::vec4& motion : planes.motion) motion *= glm::vec4(size.width, size.height, 1, 1);
    }
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) {
        files.push_back(std::filesystem::path(out).replace_extension(name + ".exr"));
        const auto written = writeExr(files.back(), static_cast<int>(size.width),
                                      static_cast<int>(size.height), makeAov(planes, name));
        if (!written) return tl::unexpected(written.error());
    }
    return files;
}

}  // namespace lodestar::app
