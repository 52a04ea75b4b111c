// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/depth_edges.hpp"
#include "app/bench/published.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::Levers;
using budget::median;
using budget::Term;
using upsample::Reconstruct;

constexpr int kWarmUp = 1;  // rounds that are not measured

/// A scene of the paper: which term is its expensive one, and the share of the full-quality frame
/// that it has there, (1 − 1/speed-up) / (1 − 1/r²) of Figure 2.
struct PaperScene {
    const char* name;
    const char* file;
    const char* camera;
    const char* builtin;  ///< where the model is not there
    Term term;
    double share;
    double leastSpeedup, leastDb;  ///< of fine-grained resizing at some r
};
constexpr std::array kPaperScenes{
    PaperScene{"car", "lamborghini.glb", "front", "builtin:columns", Term::shadow, 0.93, 9.3, 42},
    PaperScene{"chess", "chess_abeautifulgame.glb", "player", "builtin:spheres", Term::ao, 0.92, 6.6,
               38},
    PaperScene{"dragon", "stanford_dragon_res2.glb", "side", "builtin:spheres", Term::noise, 0.65,
               2.6, 40},
};

/// One way to spend less than full quality.
struct Way {
    const char* name;
    Reconstruct reconstruct;
    float repair;
    bool resizeAll;
};
constexpr std::array kWays{
    Way{"conventional", Reconstruct::bilinear, 0, true},
    Way{"full resizing", Reconstruct::bilateral, 0, true},
    Way{"fine-grained bilinear", Reconstruct::bilinear, 0, false},
    Way{"fine-grained nearest-depth", Reconstruct::nearestDepth, 0, false},
    Way{"fine-grained", Reconstruct::bilateral, 0, false},
    Way{"fine-grained + repair", Reconstruct::bilateral, kRepair, false},
};

/// The load of the expensive term, as its setting and as what it is a multiple of.
struct Load {
    std::uint32_t setting;  ///< N of N×N taps of the sun or of each view of the sky; octaves
    double share = 0;       ///< K / (K + C) measured
};

frame::FrameSettings withLoad(frame::FrameSettings settings, Term term, std::uint32_t load) {
    settings.shadowTaps = term == Term::shadow ? load : 0;
    settings.skyViews = term == Term::ao ? shared::LS_MAX_SKY_VIEWS : 0;
    settings.skyTaps = term == Term::ao ? load : 2;
    settings.noiseOctaves = term == Term::noise ? load : 0;
    return settings;
}

std::uint32_t paperLoad(Term term) {
    return term == Term::shadow ? 9 : term == Term::ao ? 2 : 6;
}

double passMs(const gpu::FrameTimes& times, const char* name) {
    double sum = 0;
    for (const gpu::PassTime& pass : times.passes)
        if (pass.name == name) sum += pass.ms;
    return sum;
}

/// The share of the terms in the full-quality frame; medians of three.
double shareOf(frame::Frame& frame, const scene::Camera& camera) {
    std::vector<double> shares;
    frame.render(camera, {});
    for (int i = 0; i < 3; ++i) {
        const gpu::FrameTimes times = frame.render(camera, {});
        shares.push_back(passMs(times, "terms") / times.gpuMs);
    }
    return median(shares);
}

/// The load at which the term has the paper's share of the frame, from its share at the paper's own
/// load: the cost of taps grows with (N + 1)², that of octaves with their number.
std::uint32_t loadFor(Term term, double wanted, double share) {
    const double factor = wanted / (1 - wanted) * (1 - share) / share;
    const double now = paperLoad(term);
    if (term == Term::noise)
        return static_cast<std::uint32_t>(std::clamp(std::round(now * factor), 1.0, 12.0));
    return static_cast<std::uint32_t>(
        std::clamp(std::round((now + 1) * std::sqrt(factor)) - 1, 1.0, 32.0));
}

}  // namespace
}  // namespace lodestar::app
