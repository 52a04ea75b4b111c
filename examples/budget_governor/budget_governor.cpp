// SPDX-License-Identifier: Apache-2.0
// Holds a frame time with lodestar's governor, without Vulkan: the renderer is simulated. A host
// puts its own frame in the place of SimulatedRenderer and its own GPU times in that of frameMs().
#include <cmath>
#include <cstdio>
#include <random>

#include <lodestar/budget/controllers.hpp>
#include <lodestar/budget/trace.hpp>

namespace {

namespace budget = lodestar::budget;

/// A frame of K/r² + C with noise, and a scene that becomes half as heavy again halfway.
class SimulatedRenderer {
public:
    double frameMs(int frame, double r) {
        const double load = frame < kFrames / 2 ? 1.0 : 1.5;
        return load * (kCoarseMs / (r * r) + kOtherMs) * (1 + noise(random));
    }
    static constexpr int kFrames = 240;
    static constexpr double kCoarseMs = 70, kOtherMs = 20;

private:
    std::mt19937 random{1};
    std::normal_distribution<double> noise{0, 0.02};
};

}  // namespace

int main() {
    constexpr double kTargetMs = 50;
    SimulatedRenderer renderer;

    // Calibration: what the coarse terms cost follows from two frames at different r.
    const budget::CostModel model =
        budget::fitCostModel(1, renderer.frameMs(0, 1), 3, renderer.frameMs(0, 3));
    std::printf("calibrated: %.1f ms of coarse terms at r = 1, %.1f ms of the rest\n", model.k,
                model.c);

    budget::YangController controller({.targetMs = kTargetMs, .k = model.k});
    budget::Levers levers;
    budget::Trace trace;
    for (int frame = 0; frame < SimulatedRenderer::kFrames; ++frame) {
        const double r = levers.shadingRate;  // the host shades ⌈W/r⌉ × ⌈H/r⌉ of W × H
        const double ms = renderer.frameMs(frame, r);
        trace.add({.rate = r, .ms = ms, .targetMs = kTargetMs});
        if (frame % 20 == 0) std::printf("frame %3d  r = %.2f  %5.1f ms\n", frame, r, ms);
        levers = controller.next({.gpuMs = ms, .passes = {}});
    }
    const double held = trace.shareWithin(0.1);
    std::printf("target %.0f ms: median %.1f ms, %.0f %% of the frames within 10 %%\n", kTargetMs,
                trace.medianMs(), 100 * held);
    return held >= 0.9 ? 0 : 1;
}
