// SPDX-License-Identifier: Apache-2.0
#include "app/judge.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include <lodestar/geometry/cull_params.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/console.hpp"

namespace lodestar::app {

QualityFigures qualityOf(const quality::RgbImage& reference, const quality::RgbImage& test) {
    const bool forSsim = reference.width >= 11 && reference.height >= 11;
    return {quality::psnr(reference, test), forSsim ? quality::ssim(reference, test) : NAN,
            quality::flip(reference, test)};
}

RunQuality judgeRun(const Session& session, frame::Frame& frame, const Run& run, double fps) {
    assert(!run.samples.empty());
    RunQuality quality;
    std::vector<double> psnr, ssim, flip;
    Progress bar("comparing with full quality", run.samples.size());
    for (const Sample& sample : run.samples) {
        if (session.gpuScene->animated())
            session.gpuScene->animate(static_cast<float>(static_cast<double>(sample.index) / fps));
        frame.render(sample.camera, {});
        quality.lastReference = readDisplay(*session.device, frame);
        const QualityFigures figures = qualityOf(quality.lastReference, sample.picture);
        quality.frames.push_back(figures);
        psnr.push_back(figures.psnrDb);
        ssim.push_back(figures.ssim);
        flip.push_back(figures.flip);
        bar.update(quality.frames.size());
    }
    quality.median = {budget::median(psnr), budget::median(ssim), budget::median(flip)};
    quality.worstPsnrDb = *std::min_element(psnr.begin(), psnr.end());
    return quality;
}

Json countsOf(const Session& session, const frame::Frame& frame) {
    const gpu::Device& device = *session.device;
    const scene::GpuScene& scene = *session.gpuScene;
    const geometry::DrawList& list = frame.drawList();
    const auto counts = gpu::as<shared::VisibleCounts>(
        gpu::readBuffer(device, list.counts, sizeof(shared::VisibleCounts)))[0];
    std::set<std::uint32_t> instances;
    if (counts.clusters > 0) {
        const auto visible =
            gpu::as<std::uint32_t>(gpu::readBuffer(device, list.visible, 4ull * counts.clusters));
        const auto clusters = gpu::as<shared::GpuCluster>(
            gpu::readBuffer(device, scene.clusters.buffer(),
                            sizeof(shared::GpuCluster) * std::size_t{scene.clusterCount()}));
        for (const std::uint32_t cluster : visible) instances.insert(clusters[cluster].instance);
    }
    const auto draws = gpu::as<vk::DrawIndirectCommand>(
        gpu::readBuffer(device, list.draws, scene::kDrawBins * sizeof(vk::DrawIndirectCommand)));
    std::uint64_t triangles = 0;
    for (const auto& draw : draws) triangles += draw.vertexCount / 3;
    return {
        {"instances_total", scene.instanceCount()},     {"instances_visible", instances.size()},
        {"clusters_total", scene.clusterCount() - 1},   {"clusters_visible", counts.clusters},
        {"triangles_total", scene.triangleCount()},     {"triangles_visible", triangles},
        {"repaired_pixels", frame.repairedPixels()},    {"refined_texels", frame.refinedTexels()},
        {"triangles_per_lod", Json::array({triangles})}};  // there is one level of detail
}

Result<void> validationVerdict(const gpu::Device& device) {
    const auto messages = device.validationMessages();
    if (messages.empty()) return {};
    return fail(fmt::format("the validation layers said {} things, first: {}", messages.size(),
                            printable(messages.front())));
}

}  // namespace lodestar::app
