// SPDX-License-Identifier: Apache-2.0
// Frames of a thin lattice before a wall, in the sun: all that coarse terms get wrong.
#pragma once

#include <glm/gtc/packing.hpp>

#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {

using budget::Levers;
using scene::Camera;
using scene::Scene;

/// Thin vertical bars before a floor and a wall, in the sun.
inline Scene fence() {
    small_scenes::SceneBuilder builder("fence");
    const std::uint32_t material = builder.add(scene::Material{.doubleSided = true});
    const auto add = [&](const char* name, glm::vec3 corner, glm::vec3 a, glm::vec3 b) {
        builder.place(builder.add(
            name,
            small_scenes::parts::patch(small_scenes::parts::rectangle(corner, a, b), 1, 1, {1, 1}),
            material));
    };
    add("floor", {-4, 0, -4}, {0, 0, 8}, {8, 0, 0});
    add("wall", {-4, 0, -4}, {8, 0, 0}, {0, 4, 0});
    for (int i = 0; i < 12; ++i) add("bar", {-3 + 0.5f * float(i), 0, 1}, {0.03f, 0, 0}, {0, 2, 0});
    return std::move(builder).finish();
}

inline const Camera kView{.eye = {0.3f, 1.6f, 5}, .at = {0, 1, 0}, .verticalFov = 0.8f};

struct Rig {
    Scene source;
    scene::GpuScene onGpu;
    Frame frame;
    const gpu::Device& device;

    explicit Rig(const gpu::Device& owner,
                 FrameSettings settings = {.size = {160, 96}, .shadowMapSize = 512},
                 Scene shown = fence())
        : source(std::move(shown)),
          onGpu(owner, source),
          frame(owner, onGpu, keepingTerms(settings)),
          device(owner) {}

    static FrameSettings keepingTerms(FrameSettings settings) {
        settings.keepTerms = true;
        return settings;
    }

    std::vector<glm::vec4> terms(const Levers& levers) {
        frame.render(kView, levers);
        std::vector<glm::vec4> values;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device, frame.terms())))
            values.push_back(glm::unpackHalf4x16(bits));
        return values;
    }
};

inline double errorOf(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::vec2 d = glm::vec2(a[i]) - glm::vec2(b[i]);
        sum += glm::dot(d, d);
    }
    return sum / double(a.size());
}

}  // namespace lodestar::frame
