// SPDX-License-Identifier: Apache-2.0
#include "app/geometry_options.hpp"

#include <array>

#include <fmt/format.h>

#include "app/cli.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kGroup = "Geometry";
constexpr std::array kCullNames{"none", "frustum", "hiz"};  // of geometry::CullMode

Result<std::vector<float>> parseDistances(const std::string& text) {
    std::vector<float> distances;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const Result<double> number = parseNumber(text.substr(begin, end - begin));
        if (!number || !(*number > 0) || (!distances.empty() && *number <= distances.back()))
            return fail("'" + text + "' is no list of distances: give growing numbers above 0");
        distances.push_back(static_cast<float>(*number));
        begin = end + 1;
    }
    if (distances.size() > 8) return fail("more than 8 distances");
    return distances;
}

Result<float> parseWave(const std::string& text) {
    const Result<double> pixels = parseNumber(text);
    if (!pixels || !(*pixels == 0 || (*pixels >= 1 && *pixels <= 1e4)))
        return fail("'" + text + "' is no length of waves: give pixels, 1 to 10000, or 0");
    return static_cast<float>(*pixels);
}

}  // namespace

Result<geometry::LodChoice> parseLod(const std::string& text) {
    using Mode = geometry::LodChoice::Mode;
    geometry::LodChoice lod;
    if (text == "off") return lod;
    if (text.starts_with("error:")) {
        const Result<double> pixels = parseNumber(text.substr(6));
        if (pixels && *pixels > 0 && *pixels <= 1e6) {
            lod.mode = Mode::error;
            lod.errorPx = static_cast<float>(*pixels);
            return lod;
        }
    }
    if (text.starts_with("distance:")) {
        const auto distances = parseDistances(text.substr(9));
        if (!distances) return tl::unexpected(distances.error());
        lod.mode = Mode::distance;
        lod.distances = *distances;
        return lod;
    }
    return fail("'" + text +
                "' is no choice of levels: give off, error:PIXELS or distance:D1,D2,... such as "
                "error:1 or distance:20,60");
}

Result<geometry::CullMode> parseCull(const std::string& text) {
    for (std::size_t i = 0; i < kCullNames.size(); ++i)
        if (text == kCullNames[i]) return geometry::CullMode(i);
    return fail("'" + text + "' is no way of culling: one of none, frustum, hiz");
}

std::string nameOf(geometry::CullMode mode) {
    return kCullNames[static_cast<std::size_t>(mode)];
}

std::string nameOf(const geometry::LodChoice& lod) {
    using Mode = geometry::LodChoice::Mode;
    if (lod.mode == Mode::off) return "off";
    if (lod.mode == Mode::error) return fmt::format("error:{:g}", lod.errorPx);
    std::string text = "distance:";
    for (std::size_t i = 0; i < lod.distances.size(); ++i)
        text += fmt::format("{}{:g}", i == 0 ? "" : ",", lod.distances[i]);
    return text;
}

void addGeometryOptions(CLI::App& app, frame::FrameSettings& settings) {
    settings.cull = geometry::CullMode::hiz;
    settings.lod = {.mode = geometry::LodChoice::Mode::error, .errorPx = 1, .distances = {}};
    addParsed(app, "--cull", settings.cull, parseCull,
              "what is not drawn: none: nothing is left out; frustum: what is out of view; hiz: "
              "also what is hidden")
        ->type_name("none|frustum|hiz")
        ->default_str(nameOf(settings.cull))
        ->group(kGroup);
    addParsed(app, "--lod", settings.lod, parseLod,
              "levels of detail: off; error:PX: the coarsest that is off by at most PX pixels; "
              "distance:D1,D2,...: level 1 from D1 on, and so forth")
        ->type_name("off|error:PX|distance:D,...")
        ->default_str(nameOf(settings.lod))
        ->group(kGroup);
    settings.wavePx = 16;
    addParsed(app, "--relief", settings.wavePx, parseWave,
              "refine displaced surfaces (builtin:mountains) where waves of their relief are at "
              "least PX pixels long; 0: leave them as they are")
        ->type_name("PX")
        ->default_str("16")
        ->group(kGroup);
    app.add_flag("--show-lods", settings.showLods,
                 "colour the picture by level of detail: red, green, blue, then yellow to white")
        ->group(kGroup);
}

}  // namespace lodestar::app
