// SPDX-License-Identifier: Apache-2.0
#include "app/scale_options.hpp"

#include <fmt/format.h>

#include "app/cli.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kGroup = "Shading";

}  // namespace

Result<budget::AxisScale> parseAxisScale(const std::string& text) {
    const std::size_t cross = text.find('x');
    const Result<double> x = parseNumber(text.substr(0, cross));
    const Result<double> y = cross == std::string::npos ? x : parseNumber(text.substr(cross + 1));
    const auto fits = [](const Result<double>& s) { return s && *s >= 0.5 && *s <= 2; };
    if (fits(x) && fits(y))
        return budget::AxisScale(static_cast<float>(*x), static_cast<float>(*y));
    return fail("'" + text + "' is no scale: give 0.5 … 2, or one for each axis, such as 0.5x1");
}

std::string nameOf(budget::AxisScale scale) {
    return scale.x == scale.y ? fmt::format("{}", scale.x) : fmt::format("{}x{}", scale.x, scale.y);
}

void addScaleOptions(CLI::App& app, budget::Levers& levers) {
    app.add_option("--shadow-scale", levers.shadowScale,
                   "draw the depth maps of sun and sky at this share of their texels a side")
        ->type_name("S")
        ->check(CLI::Range(0.25, 1.0))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--layer-scale", levers.layerScale,
                   "render alpha-blended surfaces at this share of the size along each axis")
        ->type_name("S")
        ->check(CLI::Range(0.25, 1.0))
        ->capture_default_str()
        ->group(kGroup);
    addParsed(app, "--scale,--render-scale", levers.renderScale, parseAxisScale,
              "render at this share of the size, 0.5 … 2 along each axis or one for each (0.5x1: "
              "half as wide), and scale the picture; above 1: supersampled")
        ->type_name("S|SXxSY")
        ->default_str("1")
        ->group(kGroup);
}

Json scalesJson(const budget::Levers& levers) {
    const budget::AxisScale s = levers.renderScale;
    return {{"render_scale", s.mean()},
            {"render_scale_axes", {s.x, s.y}},
            {"layer_scale", levers.layerScale},
            {"shadow_scale", levers.shadowScale}};
}

}  // namespace lodestar::app
