// SPDX-License-Identifier: Apache-2.0
// embed_upsample OUT.png [DEVICE]: lodestar's joint bilateral upsampling in a program that has its
// own renderer. Lighting is computed at a sixteenth of the pixels, brought to full resolution on
// the GPU, and multiplied with full-resolution albedo. Prints how far bilinear and bilateral
// upsampling are from lighting at every pixel.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include <stb_image_write.h>
#include <glm/gtc/packing.hpp>

#include <lodestar/shared/octahedral.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>
#include <lodestar/upsample/upsample.hpp>

#include "tiny_renderer.hpp"

namespace {

namespace gpu = lodestar::gpu;
namespace quality = lodestar::quality;
namespace upsample = lodestar::upsample;
using Usage = vk::ImageUsageFlagBits;

constexpr int kWidth = 480, kHeight = 320;
constexpr float kRate = 4;

template <typename T>
gpu::Image makeImage(const gpu::Device& device, const char* name, vk::Format format, int width,
                     int height, const std::vector<T>& texels) {
    gpu::Image image(device, {.name = name,
                              .format = format,
                              .extent = {std::uint32_t(width), std::uint32_t(height)},
                              .usage = Usage::eSampled | Usage::eStorage | Usage::eTransferDst |
                                       Usage::eTransferSrc});
    gpu::uploadImage(device, image, 0, std::as_bytes(std::span(texels)));
    return image;
}

/// As packCoarse() of lodestar/upsample/coarse_texel.glsl, which a host that shades on the GPU
/// calls in its own shader.
std::vector<glm::uvec4> packed(const tiny::Lighting& s) {
    std::vector<glm::uvec4> texels;
    for (std::size_t i = 0; i < s.light.size(); ++i) {
        const glm::vec3 light = s.light[i], n = s.normal[i];
        texels.push_back({glm::packHalf2x16({light.r, light.g}), glm::packHalf2x16({light.b, 0}),
                          glm::floatBitsToUint(s.depth[i]),
                          glm::packHalf2x16(glm::vec2(n) / std::max(n.z, 0.05f))});
    }
    return texels;
}

std::vector<glm::vec3> upsampled(const gpu::Device& device, upsample::Reconstruct kind,
                                 const tiny::Lighting& coarse, const tiny::GBuffer& full) {
    std::vector<std::uint32_t> normals;
    for (const glm::vec3& n : full.normal) normals.push_back(lodestar::shared::packNormal(n));
    const std::vector<glm::uvec4> texels = packed(coarse);
    const gpu::Image s = makeImage(device, "lighting", vk::Format::eR32G32B32A32Uint, coarse.width,
                                   coarse.height, texels);
    const gpu::Image depth =
        makeImage(device, "depth", vk::Format::eR32Sfloat, full.width, full.height, full.depth);
    const gpu::Image normal =
        makeImage(device, "normal", vk::Format::eR32Uint, full.width, full.height, normals);
    const gpu::Image out =
        makeImage(device, "upsampled", vk::Format::eR16G16B16A16Sfloat, full.width, full.height,
                  std::vector<std::uint64_t>(full.depth.size()));

    const upsample::Upsample pass(device, kind);
    gpu::Recorder recorder(device);
    recorder.begin();
    pass.record(recorder,
                {.coarse = s, .depth = depth, .normal = normal, .size = s.extent(), .rate = kRate},
                upsample::Sigmas(), out);
    recorder.submit();

    std::vector<glm::vec3> light;
    for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device, out)))
        light.push_back(glm::unpackHalf4x16(bits));
    return light;
}

quality::RgbImage picture(const tiny::GBuffer& g, const std::vector<glm::vec3>& light) {
    quality::RgbImage image(g.width, g.height);
    for (std::size_t i = 0; i < light.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float linear = g.depth[i] == 0 ? 0.6f : g.albedo[i][c] * light[i][c];
            const float shown = std::pow(std::clamp(linear, 0.0f, 1.0f), 1 / 2.2f);
            image.rgb[3 * i + std::size_t(c)] = std::uint8_t(std::lround(255 * shown));
        }
    return image;
}

int run(const char* out, const char* deviceName) {
    const tiny::GBuffer g = tiny::drawGBuffer(kWidth, kHeight);
    const tiny::Lighting coarse = tiny::shade(kWidth, kHeight, kRate);
    const quality::RgbImage reference = picture(g, tiny::shade(kWidth, kHeight, 1).light);

    const gpu::Device device({.device = deviceName});
    const auto bilinear = picture(g, upsampled(device, upsample::Reconstruct::bilinear, coarse, g));
    const auto bilateral =
        picture(g, upsampled(device, upsample::Reconstruct::bilateral, coarse, g));
    std::printf("%s\nbilinear   %.1f dB\nbilateral  %.1f dB\n", device.description().name.c_str(),
                quality::psnr(reference, bilinear), quality::psnr(reference, bilateral));
    if (!stbi_write_png(out, kWidth, kHeight, 3, bilateral.rgb.data(), 3 * kWidth)) {
        std::fprintf(stderr, "embed_upsample: error: %s: cannot be written\n", out);
        return 1;
    }
    std::printf("wrote %s\n", out);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        std::fprintf(stderr, "usage: embed_upsample OUT.png [DEVICE]\n");
        return 2;
    }
    try {
        return run(argv[1], argc > 2 ? argv[2] : "");
    } catch (const std::exception& e) {
        std::fprintf(stderr, "embed_upsample: error: %s\n", e.what());
        return 1;
    }
}
