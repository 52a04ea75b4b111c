// SPDX-License-Identifier: Apache-2.0
#include "app/frame_options.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "app/capture.hpp"
#include "app/cli.hpp"
#include "app/geometry_options.hpp"
#include "app/post_options.hpp"
#include "app/scale_options.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kGroup = "Shading";
constexpr std::uint32_t kOctaves = 6;  // of noise where it is asked for by name
constexpr float kMetered = 0;          // of FrameSettings::exposure

Result<upsample::Reconstruct> parseReconstruct(const std::string& text) {
    const auto& names = upsample::kReconstructNames;
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return upsample::Reconstruct(found - names.begin());
    std::string list;
    for (const auto name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return fail("'" + text + "' is no filter: one of " + list);
}

Result<post::ReduceFilter> parseReduce(const std::string& text) {
    if (text == "box") return post::ReduceFilter::box;
    if (text == "mitchell") return post::ReduceFilter::mitchell;
    return fail("'" + text + "' is no filter: box or mitchell");
}

Result<upsample::Packing> parsePacking(const std::string& text) {
    if (text == "full") return upsample::Packing::full;
    if (text == "yang") return upsample::Packing::yang;
    return fail("'" + text + "' is no packing: full or yang");
}

std::vector<std::string> splitList(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

Result<budget::Term> termNamed(const std::string& name) {
    const auto& names = budget::kTermNames;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return budget::Term(found - names.begin());
    return fail("'" + name + "' is no term of the shading: one of shadow, ao, noise");
}

Result<std::array<bool, budget::kTerms>> parseTerms(const std::string& text) {
    std::array<bool, budget::kTerms> chosen{};
    if (text == "none") return chosen;
    for (const std::string& name : splitList(text)) {
        const auto term = termNamed(name);
        if (!term) return tl::unexpected(term.error());
        chosen[std::size_t(*term)] = true;
    }
    return chosen;
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

/// `sky`, or `R,G,B` as display codes.
Result<std::optional<glm::vec3>> parseBackground(const std::string& text) {
    if (text == "sky") return std::optional<glm::vec3>{};
    const std::vector<std::string> parts = splitList(text);
    glm::vec3 color{0};
    bool good = parts.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
        const Result<double> code = parseNumber(parts[i]);
        good = code && *code >= 0 && *code <= 255;
        if (good) color[int(i)] = static_cast<float>(*code / 255);
    }
    if (good) return std::optional(color);
    return fail("'" + text + "' is no background: give sky, or R,G,B from 0 to 255");
}

Result<scale::Filter> parseScaleFilter(const std::string& text) {
    const auto& names = scale::kFilterNames;
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return scale::Filter(found - names.begin());
    std::string list;
    for (const auto name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return fail("'" + text + "' is no scaling filter: one of " + list);
}

Result<scale::TemporalMode> parseTemporal(const std::string& text) {
    const auto& names = scale::kTemporalNames;
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return scale::TemporalMode(found - names.begin());
    return fail("'" + text + "' is no way to join pictures: one of off, source, lodestar");
}

Result<double> parseRate(const std::string& text) {
    const Result<double> number = parseNumber(text);
    if (number && *number >= 1 && *number <= 64) return number;
    return fail("'" + text + "' is no shading rate: give a number from 1 to 64");
}

/// `4`, or `shadow=4,ao=2` with the terms not named at 1.
Result<budget::Levers> parseRates(const std::string& text) {
    budget::Levers levers;
    if (text.find('=') == std::string::npos) {
        const auto rate = parseRate(text);
        if (!rate) return tl::unexpected(rate.error());
        levers.shadingRate = static_cast<float>(*rate);
        return levers;
    }
    std::array<float, budget::kTerms> rates;
    rates.fill(1);
    for (const std::string& part : splitList(text)) {
        const std::size_t equals = part.find('=');
        const auto term = termNamed(part.substr(0, equals));
        if (!term) return tl::unexpected(term.error());
        const auto rate = parseRate(equals == std::string::npos ? "" : part.substr(equals + 1));
        if (!rate) return tl::unexpected(rate.error());
        rates[std::size_t(*term)] = static_cast<float>(*rate);
    }
    levers.shadingRate = *std::max_element(rates.begin(), rates.end());
    for (std::size_t i = 0; i < budget::kTerms; ++i)
        levers.split[i] = levers.shadingRate > 1 ? (rates[i] - 1) / (levers.shadingRate - 1) : 1.0f;
    return levers;
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

void addRepairOption(CLI::App& app, float& share) {
    share = kRepair;
    app.add_option("--repair", share,
                   "share of the pixels at most whose coarse terms are evaluated anew, where the "
                   "coarse grid missed what they show; 0: none")
        ->type_name("SHARE")
        ->check(CLI::Range(0.0, 1.0))
        ->default_str("0.02")
        ->group(kGroup);
}

void addLocalRateOption(CLI::App& app, float& spread) {
    // A flag of a number would count how often it is given.
    const auto text = std::make_shared<std::string>();
    app.add_flag(
           "--local-rate{" + fmt::format("{}", kLocalRate) + "}", *text,
           "evaluate only every second texel of the coarse grid where the terms of neighbours "
           "lie no further apart than this")
        ->type_name("[=SPREAD]")
        ->check(CLI::Range(0.0, 1.0))
        ->each([&spread, text](const std::string& given) {
            if (const auto number = parseNumber(given)) spread = static_cast<float>(*number);
        })
        ->group(kGroup);
}

void addLeverOptions(CLI::App& app, budget::Levers& levers) {
    addParsed(
        app, "--shading-rate", levers,
        [&levers](const std::string& text) {
            auto parsed = parseRates(text);
            if (!parsed) return parsed;
            budget::Levers changed = levers;
            changed.shadingRate = parsed->shadingRate;
            changed.split = parsed->split;
            return Result<budget::Levers>(changed);
        },
        "r of the coarse terms, all of them or one by one as in shadow=4,ao=2; 1 = full quality. "
        "Under a budget the proportions stay")
        ->type_name("R")
        ->default_str("1")
        ->group(kGroup);
    addRepairOption(app, levers.repair);
    addLocalRateOption(app, levers.localRate);
    app.add_flag("--full-resize,!--fine-grained", levers.resizeAll,
                 "shade as a whole on the coarse grid, not the expensive terms alone")
        ->group(kGroup);
    addScaleOptions(app, levers);
    addPostRateOption(app, levers);
}

Json leversJson(const budget::Levers& levers) {
    Json rates;
    for (std::size_t i = 0; i < budget::kTerms; ++i)
        rates[std::string(budget::kTermNames[i])] = levers.rate(budget::Term(i));
    Json json{{"shading_rate", levers.shadingRate},
              {"rates", rates},
              {"repair", levers.repair},
              {"local_rate", levers.localRate},
              {"full_resize", levers.resizeAll},
              {"post_rates", postRatesJson(levers)}};
    json.update(scalesJson(levers));
    return json;
}

void addFrameOptions(CLI::App& app, frame::FrameSettings& settings) {
    addParsed(
        app, "--terms", settings,
        [&settings](const std::string& text) -> Result<frame::FrameSettings> {
            const auto chosen = parseTerms(text);
            if (!chosen) return tl::unexpected(chosen.error());
            frame::FrameSettings changed = settings;
            if (!(*chosen)[std::size_t(budget::Term::shadow)]) changed.shadowTaps = 0;
            if (!(*chosen)[std::size_t(budget::Term::ao)]) changed.skyViews = 0;
            const bool noise = (*chosen)[std::size_t(budget::Term::noise)];
            changed.noiseOctaves = noise ? std::max(changed.noiseOctaves, kOctaves) : 0;
            return changed;
        },
        "the expensive terms that the shading has: shadow, ao, noise, or none")
        ->type_name("TERM[,TERM]")
        ->default_str("shadow,ao")
        ->group(kGroup);
    app.add_option("--noise-octaves", settings.noiseOctaves,
                   "octaves of the procedural pattern on all surfaces; 0: none")
        ->type_name("N")
        ->check(CLI::Range(0, 12))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--noise-warps", settings.noiseWarps,
                   "times the pattern warps its own domain, three patterns more each")
        ->type_name("N")
        ->check(CLI::Range(0, 8))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--noise-scale", settings.noiseScale,
                   "size of the pattern's largest cells, in scene units; 0: chosen")
        ->type_name("D")
        ->check(CLI::NonNegativeNumber)
        ->group(kGroup);
    app.add_option("--supersample", settings.supersample,
                   "render at N times the size along an axis and filter down; the expensive terms "
                   "are evaluated no more often")
        ->type_name("N")
        ->check(CLI::Range(1, 4))
        ->capture_default_str()
        ->group(kGroup);
    addParsed(app, "--supersample-filter", settings.reduce, parseReduce,
              "how it is filtered down: box or mitchell")
        ->type_name("FILTER")
        ->default_str("box")
        ->group(kGroup);
    addParsed(app, "--reconstruct", settings.reconstruct, parseReconstruct,
              "how coarse terms are brought to full size: bilateral (default), bilinear, "
              "biquadratic, bicubic, gaussian, nearest or nearest-depth")
        ->type_name("FILTER")
        ->group(kGroup);
    addParsed(
        app, "--packing", settings.packing, parsePacking,
        "what the coarse grid keeps: full (halves), or yang, the 8 and 16 bits of the paper's "
        "RGBA16 target")
        ->type_name("full|yang")
        ->default_str("full")
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
    addParsed(app, "--scale-filter,--filter", settings.scaling.filter, parseScaleFilter,
              "how a picture of another --scale is brought to size: edge-adaptive (default), "
              "bicubic, bilinear, point, noise or noise-offset")
        ->type_name("FILTER")
        ->group(kGroup);
    addParsed(app, "--temporal", settings.temporal.mode, parseTemporal,
              "join the pictures of a run: off (default), source (this one and the one before, "
              "2011) or lodestar (a history that follows the surfaces)")
        ->type_name("MODE")
        ->group(kGroup);
    app.add_option("--temporal-k", settings.temporal.k,
                   "source: share of the picture before that a pixel of motion takes away")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--temporal-width", settings.temporal.width,
                   "lodestar: width of the kernel that weighs samples, in pixels; the smaller, the "
                   "sharper and the more aliased")
        ->check(CLI::Range(0.1, 2.0))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--temporal-memory", settings.temporal.memory,
                   "lodestar: samples that a pixel remembers; 0: none, every frame stands alone")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--sharpen", settings.temporal.sharpness, "lodestar: sharpening; 0: none")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--shadow-taps", settings.shadowTaps, "N of the N×N shadow filter; 0: no shadow")
        ->type_name("N")
        ->check(CLI::Range(0, 128))
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
    addParsed(app, "--background", settings.backdrop, parseBackground,
              "what is seen past the scene: the sky, or one colour; the sky lights it all the same")
        ->type_name("sky|R,G,B")
        ->default_str("sky")
        ->group(kGroup);
    settings.exposure = kMetered;
    addParsed(app, "--exposure", settings.exposure, parseExposure,
              "multiplies the light before the tone map; auto: metered on the first frame")
        ->type_name("auto|X")
        ->default_str("auto")
        ->group(kGroup);
    addPostOptions(app, settings.post);
}

Json backgroundJson(const std::optional<glm::vec3>& color) {
    if (!color) return "sky";
    return {255 * color->r, 255 * color->g, 255 * color->b};
}

Json settingsJson(const frame::FrameSettings& s) {
    return {{"width", s.size.width},
            {"height", s.size.height},
            {"cull", nameOf(s.cull)},
            {"lod", nameOf(s.lod)},
            {"relief_px", s.wavePx},
            {"supersample", s.supersample},
            {"supersample_filter", s.reduce == post::ReduceFilter::box ? "box" : "mitchell"},
            {"capture_rate", s.captureSide * s.captureSide},
            {"capture", nameOf(s.capture)},
            {"reconstruct", nameOf(s.reconstruct)},
            {"packing", s.packing == upsample::Packing::full ? "full" : "yang"},
            {"max_scale", s.maxScale.largest()},
            {"scale_filter", std::string(scale::kFilterNames[std::size_t(s.scaling.filter)])},
            {"temporal", std::string(scale::kTemporalNames[std::size_t(s.temporal.mode)])},
            {"temporal_k", s.temporal.k},
            {"temporal_width", s.temporal.width},
            {"temporal_memory", s.temporal.memory},
            {"sharpness", s.temporal.sharpness},
            {"sigma_z", sigmaJson(s.sigmas.z)},
            {"sigma_n", sigmaJson(s.sigmas.n)},
            {"shadow_taps", s.shadowTaps},
            {"shadow_map_texels", s.shadowMapSize},
            {"shadow_distance", s.shadowDistance},
            {"ao_views", s.skyViews},
            {"ao_taps", s.skyTaps},
            {"ao_map_texels", s.skyMapSize},
            {"noise_octaves", s.noiseOctaves},
            {"noise_warps", s.noiseWarps},
            {"noise_scale", s.noiseScale},
            {"to_sun", {s.toSun.x, s.toSun.y, s.toSun.z}},
            {"post", postJson(s.post)},
            {"background", backgroundJson(s.backdrop)},
            {"exposure", s.exposure == kMetered ? Json("auto") : Json(s.exposure)}};
}

}  // namespace lodestar::app
