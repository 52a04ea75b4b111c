// SPDX-License-Identifier: Apache-2.0
#include "app/frame_options.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "app/cli.hpp"
#include "app/geometry_options.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kGroup = "Shading";
constexpr float kMetered = 0;  // of FrameSettings::exposure

Result<upsample::Reconstruct> parseReconstruct(const std::string& text) {
    const auto& names = upsample::kReconstructNames;
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return upsample::Reconstruct(found - names.begin());
    std::string list;
    for (const auto name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return fail("'" + text + "' is no filter: one of " + list);
}

Result<float> parseSigma(const std::string& text) {
    if (text == "inf") return std::numeric_limits<float>::infinity();
    const Result<double> number = parseNumber(text);
    if (number && *number > 0) return static_cast<float>(*number);
    return fail("'" + text + "' is no width: give a number above 0, or inf");
}

Result<float> parseExposure(const std::string& text) {
    if (text == "auto") return kMetered;
    const Result<double> number = parseNumber(text);
    if (number && *number > 0) return static_cast<float>(*number);
    return fail("'" + text + "' is no exposure: give a number above 0, or auto");
}

/// Azimuth (clockwise from −z, seen from above) and elevation, in degrees.
Result<glm::vec3> parseSun(const std::string& text) {
    const std::size_t comma = text.find(',');
    if (comma != std::string::npos) {
        const Result<double> azimuth = parseNumber(text.substr(0, comma));
        const Result<double> elevation = parseNumber(text.substr(comma + 1));
        if (azimuth && elevation && std::abs(*elevation) <= 90) {
            const double a = glm::radians(*azimuth), e = glm::radians(*elevation);
            return glm::vec3(std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e));
        }
    }
    return fail("'" + text + "' is no sun: give AZIMUTH,ELEVATION in degrees, such as 125,53");
}

Json sigmaJson(float sigma) {
    return std::isinf(sigma) ? Json("inf") : Json(sigma);
}

}  // namespace

std::string nameOf(upsample::Reconstruct kind) {
    return std::string(upsample::kReconstructNames[static_cast<std::size_t>(kind)]);
}

void addFrameOptions(CLI::App& app, frame::FrameSettings& settings) {
    addGeometryOptions(app, settings);
    addParsed(app, "--reconstruct", settings.reconstruct, parseReconstruct,
              "how coarse terms are brought to full size: bilateral (default), bilinear, "
              "biquadratic, bicubic, gaussian or nearest")
        ->type_name("FILTER")
        ->group(kGroup);
    addParsed(app, "--sigma-z", settings.sigmas.z, parseSigma,
              "how unlike in depth a tap may be, relative to the depth; inf: any")
        ->type_name("S")
        ->default_str(fmt::format("{}", settings.sigmas.z))
        ->group(kGroup);
    addParsed(app, "--sigma-n", settings.sigmas.n, parseSigma,
              "how unlike in normal a tap may be; inf: any")
        ->type_name("S")
        ->default_str(fmt::format("{}", settings.sigmas.n))
        ->group(kGroup);
    app.add_option("--shadow-taps", settings.shadowTaps, "N of the N×N shadow filter; 0: no shadow")
        ->type_name("N")
        ->check(CLI::Range(0, 32))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--shadow-map", settings.shadowMapSize, "shadow map texels a side")
        ->type_name("N")
        ->check(CLI::Range(16, 16384))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--shadow-distance", settings.shadowDistance,
                   "how far from the camera shadows are drawn, in scene units; 0: chosen")
        ->type_name("D")
        ->check(CLI::NonNegativeNumber)
        ->group(kGroup);
    app.add_option("--ao-views", settings.skyViews,
                   "directions of the sky that ambient occlusion looks in; 0: no occlusion")
        ->type_name("N")
        ->check(CLI::Range(0, 16))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--ao-taps", settings.skyTaps, "N of the N×N filter of each direction")
        ->type_name("N")
        ->check(CLI::Range(1, 32))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--ao-map", settings.skyMapSize, "depth map texels a side, each direction")
        ->type_name("N")
        ->check(CLI::Range(16, 4096))
        ->capture_default_str()
        ->group(kGroup);
    addParsed(app, "--sun", settings.toSun, parseSun,
              "where the sun stands, in degrees; a directional light of the scene takes its place")
        ->type_name("AZ,EL")
        ->default_str("125,53")
        ->group(kGroup);
    settings.exposure = kMetered;
    addParsed(app, "--exposure", settings.exposure, parseExposure,
              "multiplies the light before the tone map; auto: metered on the first frame")
        ->type_name("auto|X")
        ->default_str("auto")
        ->group(kGroup);
}

Json settingsJson(const frame::FrameSettings& s) {
    return {{"width", s.size.width},
            {"height", s.size.height},
            {"cull", nameOf(s.cull)},
            {"lod", nameOf(s.lod)},
            {"reconstruct", nameOf(s.reconstruct)},
            {"sigma_z", sigmaJson(s.sigmas.z)},
            {"sigma_n", sigmaJson(s.sigmas.n)},
            {"shadow_taps", s.shadowTaps},
            {"shadow_map_texels", s.shadowMapSize},
            {"shadow_distance", s.shadowDistance},
            {"ao_views", s.skyViews},
            {"ao_taps", s.skyTaps},
            {"ao_map_texels", s.skyMapSize},
            {"to_sun", {s.toSun.x, s.toSun.y, s.toSun.z}},
            {"exposure", s.exposure == kMetered ? Json("auto") : Json(s.exposure)}};
}

}  // namespace lodestar::app
