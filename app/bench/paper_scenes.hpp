// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "app/bench/bench.hpp"

/// The scenes of Yang et al. 2008, with real models, for the benches that measure them.
namespace lodestar::app {

/// Which term is the scene's expensive one, and the share of the full-quality frame that it has in
/// the paper, (1 − 1/speed-up) / (1 − 1/r²) of Figure 2.
struct PaperScene {
    const char* name;
    const char* file;
    const char* camera;
    budget::Term term;
    double share;
    double leastSpeedup, leastDb;  ///< of fine-grained resizing at some r
    double overBilinearDb;         ///< of full resizing over conventional, at equal time
};
inline constexpr std::array kPaperScenes{
    PaperScene{"car", "lamborghini.glb", "front", budget::Term::shadow, 0.930, 9.3, 42, 3},
    PaperScene{"chess", "chess_abeautifulgame.glb", "player", budget::Term::ao, 0.924, 6.6, 38, 2},
    PaperScene{"dragon", "stanford_dragon_res2.glb", "side", budget::Term::noise, 0.656, 2.6, 40,
               7},
};

/// How heavy a term is: N of the N×N taps, or octaves and warps of noise.
struct Load {
    std::uint32_t amount = 1, warps = 0;
};
/// The paper's own: 9×9 taps; its other loads are not printed.
Load paperLoad(budget::Term);
/// `settings` with that term alone.
frame::FrameSettings withLoad(frame::FrameSettings, budget::Term, Load);
/// The load at which the term has the share `wanted` of the full-quality frame, from its share at
/// `now`.
Load loadFor(budget::Term, double wanted, Load now, double share);
/// The share of the terms in the full-quality frame; median of seven.
double shareOf(frame::Frame&, const scene::Camera&);
/// The load at which the scene's term has the paper's share on this device, found in steps; its
/// share at the paper's own load is printed.
Load findLoad(const PaperScene&, const Session&, const scene::Camera&, const frame::FrameSettings&);

double passMs(const gpu::FrameTimes&, const char* name);

/// The scene of the paper whose model a case shows; the first for a scene of the user's own.
const PaperScene& roleOf(const BenchCase&);
/// The cases of all three, or the one asked for in their place.
Result<std::vector<BenchCase>> paperCases(const BenchOptions&);

}  // namespace lodestar::app
