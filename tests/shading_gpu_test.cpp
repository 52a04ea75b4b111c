// SPDX-License-Identifier: Apache-2.0
// Combine and tone map, on pixels made up for the purpose.
#include <cmath>

#include <glm/gtc/packing.hpp>

#include <lodestar/shading/light_params.h>
#include <lodestar/shared/octahedral.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/post/tonemap.hpp>
#include <lodestar/shading/combine.hpp>

#include "gpu_device.hpp"

namespace lodestar::shading {
namespace {

using glm::vec3;
using glm::vec4;
using Usage = vk::ImageUsageFlagBits;

constexpr float kPi = 3.14159265f;

/// One pixel as Rebuild leaves it, before an eye that looks along −z.
struct Pixel {
    vec3 albedo{1};
    float occlusion = 1, roughness = 1, metallic = 0;
    std::uint32_t flags = 0;
    vec3 normal{0, 0, 1};
    vec3 emissive{0};
    float depth = 2;
    glm::vec2 visible{1, 1};  // of the sun, of the sky
};

class ShadingGpu : public GpuTest {
protected:
    template <typename T>
    static gpu::Image row(vk::Format format, const std::vector<T>& texels) {
        gpu::Image made(device(), {.name = "row",
                                   .format = format,
                                   .extent = {std::uint32_t(texels.size()), 1},
                                   .usage = Usage::eSampled | Usage::eStorage |
                                            Usage::eTransferDst | Usage::eTransferSrc});
        gpu::uploadImage(device(), made, 0, std::as_bytes(std::span(texels)));
        return made;
    }

    static gpu::Image halfRow(const std::vector<vec4>& texels) {
        std::vector<std::uint64_t> halves;
        for (const vec4& t : texels) halves.push_back(glm::packHalf4x16(t));
        return row(vk::Format::eR16G16B16A16Sfloat, halves);
    }

    /// A sky of radiance 1 and no sun.
    static shared::LightParams constantSky() {
        shared::LightParams light{.toSun = {0, 0, 1}};
        light.irradiance[0] = vec3(kPi);
        light.skyLevels = 1;
        light.exposure = light.perLux = 1;
        return light;
    }

    static gpu::Image combined(const std::vector<Pixel>& pixels, const shared::LightParams& light) {
        std::vector<float> depth;
        std::vector<glm::uvec4> material;
        std::vector<vec4> emissive, terms;
        for (const Pixel& p : pixels) {
            const std::uint32_t normal = shared::packNormal(p.normal);
            depth.push_back(p.depth);
            material.push_back({glm::packUnorm4x8(vec4(glm::sqrt(p.albedo), p.occlusion)),
                                glm::packUnorm4x8({p.roughness, p.metallic, 0, 0}) | p.flags << 16,
                                normal, normal});
            emissive.push_back(vec4(p.emissive, 0));
            terms.push_back(vec4(p.visible, 0, 0));
        }
        const gpu::Image depths = row(vk::Format::eR32Sfloat, depth);
        const gpu::Image materials = row(vk::Format::eR32G32B32A32Uint, material);
        const gpu::Image emissives = halfRow(emissive), term = halfRow(terms);
        const gpu::Image sky = halfRow(std::vector<vec4>(8, vec4(1)));
        gpu::Image radiance = halfRow(std::vector<vec4>(pixels.size()));
        const gpu::Buffer viewBuffer(device(), "view", sizeof(shared::ViewParams),
                                     gpu::Residence::mapped);
        const gpu::Buffer lightBuffer(device(), "light", sizeof light, gpu::Residence::mapped);
        const gpu::Buffer lights(device(), "lights", 0);
        // So long a lens that all rays run along −z.
        *viewBuffer.mapped<shared::ViewParams>() = {.viewFromWorld = glm::mat4(1),
                                                    .clipScale = glm::vec2(1e6f)};
        *lightBuffer.mapped<shared::LightParams>() = light;
        scene::SceneFeatures features;
        features.emissive = features.unlit = true;
        const Combine pass(device(), features);
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec, {viewBuffer, lightBuffer, depths, materials, emissives, term, sky, lights},
                    radiance);
        rec.submit();
        return radiance;
    }

    static std::vector<vec4> texelsOf(const gpu::Image& image) {
        std::vector<vec4> values;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device(), image)))
            values.push_back(glm::unpackHalf4x16(bits));
        return values;
    }

    static std::vector<glm::u8vec4> toneMapped(const gpu::Image& radiance, float exposure) {
        const gpu::Image display =
            row(vk::Format::eR8G8B8A8Unorm, std::vector<std::uint32_t>(radiance.extent().width));
        const post::Tonemap pass(device());
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec, radiance, exposure, display);
        rec.submit();
        return gpu::as<glm::u8vec4>(gpu::readImage(device(), display));
    }
};

vec3 tilted(float nDotV) {
    return {std::sqrt(1 - nDotV * nDotV), 0, nDotV};
}

TEST_F(ShadingGpu, whiteSurfacesUnderAConstantSkyReflectNoMoreThanTheyGet) {
    std::vector<Pixel> pixels;
    for (const float metallic : {0.f, 1.f})
        for (const float roughness : {0.05f, 0.25f, 0.5f, 0.75f, 1.f})
            for (const float nDotV : {0.02f, 0.1f, 0.3f, 0.6f, 1.f})
                pixels.push_back(
                    {.roughness = roughness, .metallic = metallic, .normal = tilted(nDotV)});
    const auto values = texelsOf(combined(pixels, constantSky()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Pixel& p = pixels[i];
        EXPECT_LE(values[i].x, 1.002f)
            << "roughness " << p.roughness << " metallic " << p.metallic << " n·v " << p.normal.z;
        if (p.metallic == 0) {
            EXPECT_GE(values[i].x, 0.98f) << "nothing is absorbed";
        }
    }
}

TEST_F(ShadingGpu, absorbedAndOccludedLightIsGone) {
    const auto values = texelsOf(combined(
        {{.albedo = vec3(0)}, {.occlusion = 0}, {.albedo = vec3(0.25f)}, {}, {.visible = {1, 0}}},
        constantSky()));
    EXPECT_LT(values[0].x, 0.05f);  // the specular share alone
    EXPECT_EQ(values[1].x, 0);
    EXPECT_NEAR(values[4].x, 0.3f * values[3].x, 2e-3) << "what hides the sky sends some back";
    EXPECT_NEAR(values[2].x - values[0].x, 0.25f * (values[3].x - values[0].x), 2e-3);
}

// Sun, eye and normal in line, roughness 1: D = 1/π, V = 1/4, F = f0.
TEST_F(ShadingGpu, sunAtNormalIncidenceIsTheClosedForm) {
    shared::LightParams light = constantSky();
    light.sunIlluminance = {3, 2, 1};
    const std::vector<Pixel> pixels{{.albedo = vec3(0.25f), .occlusion = 0},
                                    {.albedo = vec3(0.25f), .occlusion = 0, .visible = {0.5f, 1}},
                                    {.albedo = vec3(0.25f), .occlusion = 0, .visible = {0, 1}},
                                    {.occlusion = 0, .normal = {0, 0, -1}}};
    const auto values = texelsOf(combined(pixels, light));
    for (int c = 0; c < 3; ++c) {
        const float f0 = 0.04f, albedo = 0.25f;
        const float expected = light.sunIlluminance[c] * ((1 - f0) * albedo + f0 / 4) / kPi;
        EXPECT_NEAR(values[0][c], expected, 0.01f * expected);
        EXPECT_NEAR(values[1][c], expected / 2, 0.01f * expected);
        EXPECT_EQ(values[2][c], 0);
        EXPECT_EQ(values[3][c], 0) << "turned away from the sun";
    }
}

TEST_F(ShadingGpu, emissionIsAddedAndTheBackgroundIsSky) {
    shared::LightParams light = constantSky();
    light.toSun = {0, 1, 0};
    const auto values = texelsOf(
        combined({{.emissive = {4, 2, 0.5f}}, {}, {.emissive = vec3(7), .depth = 0}}, light));
    EXPECT_NEAR(values[0].x - values[1].x, 4, 4e-3);
    EXPECT_NEAR(values[0].z - values[1].z, 0.5, 2e-3);
    EXPECT_EQ(values[2], vec4(1));
}

TEST_F(ShadingGpu, unlitColoursAppearAsAuthored) {
    std::vector<Pixel> pixels;
    for (int code = 0; code < 256; ++code) {
        const float c = float(code) / 255;
        const float linear = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
        pixels.push_back({.albedo = {linear, 0, 1}, .flags = shared::LS_MATERIAL_UNLIT});
    }
    for (const float exposure : {0.4f, 1.f, 2.5f}) {
        shared::LightParams light = constantSky();
        light.exposure = exposure;
        const auto codes = toneMapped(combined(pixels, light), exposure);
        for (int code = 0; code < 256; ++code) {
            EXPECT_NEAR(codes[std::size_t(code)].x, code, 3) << "exposure " << exposure;
            EXPECT_EQ(codes[std::size_t(code)].y, 0);
            EXPECT_EQ(codes[std::size_t(code)].z, 255);
        }
    }
}

double srgbCode(double linear) {
    const double c = std::clamp(linear, 0.0, 1.0);
    return 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
}

/// The curve of color.glsl for a grey, whose channels its matrices keep equal to 3 digits.
double acesGrey(double linear) {
    const double v = linear / 0.6;
    return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
}

TEST_F(ShadingGpu, toneCurveOfGreysIsTheFormulaWithinACode) {
    std::vector<vec4> greys;
    for (int i = 0; i <= 400; ++i)
        greys.push_back(vec4(vec3(std::exp2(-12 + 0.05f * float(i))), 1));
    const gpu::Image image = halfRow(greys);
    for (const float exposure : {1.f, 0.25f, 3.f}) {
        const auto codes = toneMapped(image, exposure);
        for (std::size_t i = 0; i < codes.size(); ++i) {
            const double stored = glm::unpackHalf4x16(glm::packHalf4x16(greys[i])).x;
            const double expected = srgbCode(acesGrey(stored * exposure));
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(codes[i][c], expected, 1.01) << stored;
            EXPECT_EQ(codes[i].w, 255);
            if (i > 0) {
                EXPECT_GE(codes[i].x, codes[i - 1].x) << stored;
            }
        }
    }
}

TEST_F(ShadingGpu, toneCurveKeepsBlackAndClampsTheBrightest) {
    const auto codes = toneMapped(
        halfRow({{0, 0, 0, 1}, {65000, 65000, 65000, 1}, {0, 0, 0, 0}, {9, 9, 9, 0}}), 1);
    EXPECT_EQ(codes[0], glm::u8vec4(0, 0, 0, 255));
    EXPECT_EQ(codes[1], glm::u8vec4(255));
    EXPECT_EQ(codes[2], glm::u8vec4(0, 0, 0, 255));
    EXPECT_EQ(codes[3], glm::u8vec4(255));
}

TEST_F(ShadingGpu, withoutTheCurveOnlyTheEncodingIsLeft) {
    std::vector<vec4> greys;
    for (int i = 0; i <= 255; ++i) greys.push_back(vec4(vec3(float(i) / 255), 0));
    const auto codes = toneMapped(halfRow(greys), 1);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const double stored = glm::unpackHalf4x16(glm::packHalf4x16(greys[i])).x;
        EXPECT_NEAR(codes[i].x, srgbCode(stored), 0.51 + 0.1);
    }
}

}  // namespace
}  // namespace lodestar::shading
