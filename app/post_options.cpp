// SPDX-License-Identifier: Apache-2.0
#include "app/post_options.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "app/cli.hpp"

namespace lodestar::app {
namespace {

constexpr const char* kGroup = "Effects";

Result<std::uint32_t> parseRate(const std::string& text) {
    for (const std::uint32_t rate : {1u, 4u, 16u, 64u})
        if (text == std::to_string(rate)) return rate;
    return fail("'" + text + "' is no rate of an effect: 1, 4, 16 or 64");
}

/// `16`, or `ssao=4,dof=16` with those not named as they are.
Result<budget::Levers> parseRates(const std::string& text, budget::Levers levers) {
    if (text.find('=') == std::string::npos) {
        const auto rate = parseRate(text);
        if (!rate) return tl::unexpected(rate.error());
        levers.postRates.fill(*rate);
        return levers;
    }
    const auto& names = budget::kEffectNames;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        const std::size_t equals = std::min(part.find('='), part.size());
        const auto found = std::find(names.begin(), names.end(), part.substr(0, equals));
        if (found == names.end())
            return fail("'" + part + "' names no effect: one of ssao, dof, motion-blur");
        const auto rate = parseRate(equals < part.size() ? part.substr(equals + 1) : "");
        if (!rate) return tl::unexpected(rate.error());
        levers.postRates[std::size_t(found - names.begin())] = *rate;
        begin = end + 1;
    }
    return levers;
}

Result<bool> parseCombine(const std::string& text) {
    if (text == "bilateral") return true;
    if (text == "linear") return false;
    return fail("'" + text + "' is no way to combine: bilateral or linear");
}

Result<bool> parseInputs(const std::string& text) {
    if (text == "representatives") return false;
    if (text == "downsampled") return true;
    return fail("'" + text + "' are no inputs of effects: representatives or downsampled");
}

/// FOCUS[,SHARP,FULL]; lengths in scene units.
Result<post::DofOptions> parseDof(const std::string& text, post::DofOptions dof) {
    std::vector<float> lengths;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        const Result<double> number =
            begin == 0 && part == "auto" ? Result<double>(0) : parseNumber(part);
        const bool automatic = begin == 0 && part == "auto";
        if (!number || !(*number >= 0) || (begin == 0 && !automatic && *number == 0))
            return fail("'" + text +
                        "' is no depth of field: give FOCUS or auto, and the lengths "
                        "around it that are sharp and fully blurred, such as 4,0.5,3");
        lengths.push_back(static_cast<float>(*number));
        begin = end + 1;
    }
    if (lengths.size() == 2 || lengths.size() > 3)
        return fail("'" + text + "': give FOCUS alone, or FOCUS,SHARP,FULL");
    dof.focus = lengths[0];
    dof.sharp = dof.full = 0;
    if (lengths.size() == 3) {
        if (!(lengths[2] > lengths[1])) return fail("'" + text + "': FULL must be over SHARP");
        dof.sharp = lengths[1];
        dof.full = lengths[2];
    }
    return dof;
}

Result<post::CocFormula> parseFormula(const std::string& text) {
    if (text == "both") return post::CocFormula::both;
    if (text == "thesis") return post::CocFormula::thesis;
    return fail("'" + text + "' is no formula of blur: both or thesis");
}

/// Options of depth of field come in any order: they are put together in `chosen`.
void addDofOptions(CLI::App& app, std::optional<post::DofOptions>& settings) {
    const auto chosen = std::make_shared<post::DofOptions>();
    const auto use = [&settings, chosen](auto change) {
        change(*chosen);
        if (settings) settings = *chosen;
    };
    CLI::Option* dof =
        app.add_option_function<std::string>(
               "--dof",
               [&settings, chosen](const std::string& text) {
                   const auto parsed = parseDof(text, *chosen);
                   if (!parsed) throw CLI::ValidationError("--dof", parsed.error().message);
                   settings = *chosen = *parsed;
               },
               "depth of field: the distance in focus (auto: of what the camera looks at) and how "
               "far around it all is sharp and from where on all is fully blurred, in scene units")
            ->type_name("FOCUS[,SHARP,FULL]")
            ->group(kGroup);
    app.add_option_function<float>(
           "--dof-degree", [use](float d) { use([d](auto& o) { o.degree = d; }); },
           "degree of the blur, a factor of it")
        ->check(CLI::NonNegativeNumber)
        ->default_str("1")
        ->needs(dof)
        ->group(kGroup);
    app.add_option_function<float>(
           "--dof-radius", [use](float r) { use([r](auto& o) { o.radius = r; }); },
           "radius of the largest blur, as a share of the picture's height")
        ->type_name("SHARE")
        ->check(CLI::Range(0.0001, 0.1))
        ->default_str("0.012")
        ->needs(dof)
        ->group(kGroup);
    app.add_option_function<std::string>(
           "--dof-formula",
           [use](const std::string& text) {
               const auto parsed = parseFormula(text);
               if (!parsed) throw CLI::ValidationError("--dof-formula", parsed.error().message);
               use([&](auto& o) { o.formula = *parsed; });
           },
           "what blurs: both sides of the focus, or as the thesis prints it what lies past it")
        ->type_name("both|thesis")
        ->default_str("both")
        ->needs(dof)
        ->group(kGroup);
}

void addSsaoOptions(CLI::App& app, post::SsaoOptions& ssao, CLI::Option* flag) {
    app.add_option("--ssao-radius", ssao.radius,
                   "how far occluders matter, in scene units; 0: 1/40 of the scene's radius")
        ->type_name("D")
        ->check(CLI::NonNegativeNumber)
        ->needs(flag)
        ->group(kGroup);
    app.add_option("--ssao-strength", ssao.strength, "factor of what its samples found occluded")
        ->check(CLI::Range(0.0, 100.0))
        ->capture_default_str()
        ->needs(flag)
        ->group(kGroup);
    app.add_option("--ssao-bias", ssao.bias,
                   "cosine above the surface from which something occludes; the thesis: 0")
        ->check(CLI::Range(0.0, 0.99))
        ->capture_default_str()
        ->needs(flag)
        ->group(kGroup);
    app.add_option("--ssao-samples", ssao.samples, "samples a texel; nine texels share theirs")
        ->type_name("N")
        ->check(CLI::Range(1, 64))
        ->capture_default_str()
        ->needs(flag)
        ->group(kGroup);
}

}  // namespace

void addPostOptions(CLI::App& app, frame::PostSettings& settings) {
    CLI::Option* ssao =
        app.add_flag("--ssao", settings.ssao,
                     "screen-space ambient occlusion of small things, beside that by depth maps; "
                     "takes from the ambient light alone")
            ->group(kGroup);
    addSsaoOptions(app, settings.occlusion, ssao);
    addDofOptions(app, settings.dof);
    app.add_option("--motion-blur", settings.shutter,
                   "motion blur: the share of the time between two frames of a run that the "
                   "shutter is open; 0: none")
        ->type_name("SHUTTER")
        ->check(CLI::Range(0.0, 1.0))
        ->group(kGroup);
    addParsed(app, "--post-combine", settings.bilateral, parseCombine,
              "how effects come to full size: bilateral, guided by depth and normals, or linear")
        ->type_name("bilateral|linear")
        ->default_str("bilateral")
        ->group(kGroup);
    addParsed(app, "--post-inputs", settings.downsampled, parseInputs,
              "what effects are computed from: representatives, each the triangle that a coarse "
              "pixel shows, or what is downsampled from full size, to compare with")
        ->type_name("representatives|downsampled")
        ->default_str("representatives")
        ->group(kGroup);
}

void addPostRateOption(CLI::App& app, budget::Levers& levers) {
    levers.postRates = {4, 4, 4};
    addParsed(
        app, "--post-rate", levers,
        [&levers](const std::string& text) { return parseRates(text, levers); },
        "pixels that share one texel of an effect, of all effects or one by one as in "
        "ssao=4,dof=16: 1, 4, 16 or 64")
        ->type_name("N")
        ->default_str("4")
        ->group(kGroup);
}

Json postJson(const frame::PostSettings& s) {
    Json json{{"ssao", s.ssao},
              {"motion_blur", s.shutter},
              {"combine", s.bilateral ? "bilateral" : "linear"},
              {"inputs", s.downsampled ? "downsampled" : "representatives"}};
    if (s.ssao)
        json.update({{"ssao_radius", s.occlusion.radius},
                     {"ssao_strength", s.occlusion.strength},
                     {"ssao_bias", s.occlusion.bias},
                     {"ssao_samples", s.occlusion.samples}});
    if (s.dof)
        json.update(
            {{"dof_focus", s.dof->focus},
             {"dof_sharp", s.dof->sharp},
             {"dof_full", s.dof->full},
             {"dof_degree", s.dof->degree},
             {"dof_radius", s.dof->radius},
             {"dof_formula", s.dof->formula == post::CocFormula::both ? "both" : "thesis"}});
    return json;
}

Json postRatesJson(const budget::Levers& levers) {
    Json json;
    for (std::size_t i = 0; i < budget::kEffects; ++i)
        json[std::string(budget::kEffectNames[i])] = levers.postRates[i];
    return json;
}

}  // namespace lodestar::app
