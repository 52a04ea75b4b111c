// SPDX-License-Identifier: Apache-2.0
#include "app/bench/paper_scenes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/shading/light_params.h>
#include <lodestar/budget/trace.hpp>

namespace lodestar::app {

using budget::Term;

Load paperLoad(Term term) {
    return {term == Term::shadow ? 9u : term == Term::ao ? 2u : 6u, 0};
}

frame::FrameSettings withLoad(frame::FrameSettings settings, Term term, Load load) {
    settings.shadowTaps = term == Term::shadow ? load.amount : 0;
    settings.skyViews = term == Term::ao ? shared::LS_MAX_SKY_VIEWS : 0;
    settings.skyTaps = term == Term::ao ? load.amount : 2;
    settings.noiseOctaves = term == Term::noise ? load.amount : 0;
    settings.noiseWarps = term == Term::noise ? load.warps : 0;
    return settings;
}

Load loadFor(Term term, double wanted, Load now, double share) {
    const double factor = wanted / (1 - wanted) * (1 - share) / share;
    if (term == Term::noise) {
        // Sums of octaves are what costs: one, and three a warp.
        const double octaves = factor * now.amount * (1 + 3.0 * now.warps);
        const double warps = std::clamp(std::round((octaves / 6 - 1) / 3), 0.0, 8.0);
        return {static_cast<std::uint32_t>(
                    std::clamp(std::round(octaves / (1 + 3 * warps)), 1.0, 12.0)),
                static_cast<std::uint32_t>(warps)};
    }
    // The window of N taps touches N + 1 texels a side.
    const double most = term == Term::shadow ? shared::LS_MAX_SHADOW_TAPS : 32;
    return {static_cast<std::uint32_t>(
                std::clamp(std::round((now.amount + 1) * std::sqrt(factor)) - 1, 1.0, most)),
            0};
}

double passMs(const gpu::FrameTimes& times, const char* name) {
    double sum = 0;
    for (const gpu::PassTime& pass : times.passes)
        if (pass.name == name) sum += pass.ms;
    return sum;
}

double shareOf(frame::Frame& frame, const scene::Camera& camera) {
    std::vector<double> shares;
    warmUp([&] { return frame.render(camera, {}); });
    for (int i = 0; i < 7; ++i) {
        const gpu::FrameTimes times = frame.render(camera, {});
        shares.push_back(passMs(times, "terms") / times.gpuMs);
    }
    return budget::median(shares);
}

Load findLoad(const PaperScene& paper, const Session& session, const scene::Camera& camera,
              const frame::FrameSettings& settings) {
    Load load = paperLoad(paper.term);
    double share = 0, paperShare = 0;
    // What a load costs is a guess until it is measured. Not below the paper's share: what a term
    // lacks of it no resizing can save.
    constexpr double kAim = 0.008, kOver = 0.02;
    for (int step = 0; step < 6; ++step) {
        frame::Frame probe(*session.device, *session.gpuScene,
                           withLoad(settings, paper.term, load));
        share = shareOf(probe, camera);
        if (step == 0) paperShare = share;
        if (share >= paper.share && share < paper.share + kOver) break;
        load = loadFor(paper.term, paper.share + kAim, load, share);
    }
    fmt::print("{}: {} has {:.0f} % of the frame at the paper's load {}; measured at {}{}\n",
               paper.name, budget::kTermNames[static_cast<std::size_t>(paper.term)],
               100 * paperShare, paperLoad(paper.term).amount, load.amount,
               load.warps > 0 ? fmt::format(", warped {} times", load.warps) : "");
    return load;
}

const PaperScene& roleOf(const BenchCase& what) {
    const auto name = std::filesystem::path(what.scene).filename();
    const auto found = std::find_if(kPaperScenes.begin(), kPaperScenes.end(),
                                    [&](const PaperScene& paper) { return name == paper.file; });
    return found == kPaperScenes.end() ? kPaperScenes.front() : *found;
}

Result<std::vector<BenchCase>> paperCases(const BenchOptions& options) {
    std::vector<BenchCase> defaults;
    for (const PaperScene& paper : kPaperScenes) defaults.push_back({paper.file, paper.camera, ""});
    auto cases = benchCases(options, defaults);
    // The paper's have nothing that is seen through, whose terms no grid S holds.
    if (cases)
        for (BenchCase& one : *cases) one.opaque = true;
    return cases;
}

}  // namespace lodestar::app
