// SPDX-License-Identifier: Apache-2.0
#include "app/controller_options.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "app/cli.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kGroup = "Run";

using Control = std::pair<std::string_view, bool budget::ScaleControls::*>;
constexpr std::array kControls{Control{"scale", &budget::ScaleControls::render},
                               Control{"layer", &budget::ScaleControls::layer},
                               Control{"shadow", &budget::ScaleControls::shadow}};

}  // namespace

Result<void> checkController(const ControllerOptions& options, bool budget) {
    if (options.controls && !(budget && options.scales()))
        return fail("--controls: says what --budget moves with --controller proportional");
    if (!options.trace.empty() && (!budget || options.kind == "none"))
        return fail("--trace: of a run that a controller holds to a --budget");
    return {};
}

Result<budget::ScaleControls> parseControls(const std::string& text) {
    budget::ScaleControls controls{.render = false};
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string name = text.substr(begin, end - begin);
        const auto* found = std::find_if(kControls.begin(), kControls.end(),
                                         [&](const Control& c) { return c.first == name; });
        if (found == kControls.end())
            return fail("'" + name + "' is nothing to control: one or more of scale,layer,shadow");
        controls.*found->second = true;
        begin = end + 1;
    }
    return controls;
}

Json controlsJson(const budget::ScaleControls& controls) {
    Json names = Json::array();
    for (const auto& [name, member] : kControls)
        if (controls.*member) names.push_back(name);
    return names;
}

Result<budget::ProportionalSettings> proportionalSettings(const ControllerOptions& options,
                                                          const Session& session,
                                                          const frame::FrameSettings& settings) {
    budget::ScaleControls controls = options.controls.value_or(budget::ScaleControls{});
    const auto leaveOut = [](bool& control, const char* why) {
        if (control) fmt::print("note: {}\n", why);
        control = false;
    };
    if (!session.gpuScene->features().blended)
        leaveOut(controls.layer, "--controls layer: nothing in the scene is blended");
    if (!session.gpuScene->animated() && settings.shadowDistance == 0)
        leaveOut(controls.shadow,
                 "--controls shadow: nothing in the scene moves, so its depth maps are kept and a "
                 "change would only cost");
    if (!controls.any()) return fail("--controls: nothing is left to control; add scale");
    return budget::ProportionalSettings{
        .least = controls.render ? 0.5 : 0.25,
        .most = controls.render ? double(settings.maxScale.largest()) : 1,
        .hysteresis = options.hysteresis,
        .bands = options.bands,
        .controls = controls};
}

void addControllerOptions(CLI::App& app, ControllerOptions& o) {
    app.add_option("--controller", o.kind,
                   "who holds the budget: yang (r by t = K/r² + C, 2008), proportional (S, 2011; "
                   "from 0.5 to --scale or 1) or none")
        ->check(CLI::IsMember({"yang", "proportional", "none"}))
        ->capture_default_str()
        ->group(kGroup);
    addParsed(app, "--controls", o.controls, parseControls,
              "proportional: what S moves: scale (of the frame), layer (--layer-scale times S), "
              "shadow (--shadow-scale times S)")
        ->type_name("scale[,layer][,shadow]")
        ->default_str("scale")
        ->group(kGroup);
    app.add_option("--hysteresis", o.hysteresis,
                   "proportional: S rests while the time is within this share of the budget")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--bands", o.bands, "proportional: values that S may take; 0: any")
        ->check(CLI::Range(0, 64))
        ->capture_default_str()
        ->group(kGroup);
    app.add_option("--trace", o.trace,
                   "write the levers and times of every frame of a --budget run to this CSV")
        ->type_name("FILE")
        ->group(kGroup);
}

}  // namespace lodestar::app
